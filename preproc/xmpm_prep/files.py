"""Files that are there as a whole or not at all."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

from xmpm_prep.errors import FILES, PrepError


def input_file(path):
    """Path of a file that can be read."""
    path = Path(path)
    if path.is_dir():
        raise PrepError(f"{path}: it is a folder, not a file", FILES)
    if not path.is_file():
        raise PrepError(f"{path}: no such file", FILES)
    if not os.access(path, os.R_OK):
        raise PrepError(f"{path}: no permission to read it", FILES)
    return path


@contextmanager
def whole_files(*paths):
    """Temporary paths to write to; they get their names when all of them are whole.

    with whole_files("a.h5", "a.xdmf") as (data, description): ...

    Whatever goes wrong before the end of the block leaves nothing behind and old files as they are.
    """
    paths = [Path(path) for path in paths]
    made = []
    try:
        try:
            made = [_temporary(path) for path in paths]
        except OSError as failure:
            raise PrepError(f"{paths[len(made)]}: {failure.strerror}", FILES) from None
        yield tuple(made)
        for temporary, path in zip(made, paths, strict=True):
            try:
                temporary.replace(path)
            except OSError as failure:
                raise PrepError(f"{path}: {failure.strerror}", FILES) from None
    finally:
        for temporary in made:
            temporary.unlink(missing_ok=True)


def _temporary(path):
    """An empty file beside a path, hidden, with its ending, readable as any new file would be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    mask = os.umask(0)
    os.umask(mask)
    os.close(handle)
    Path(name).chmod(0o666 & ~mask)
    return Path(name)
