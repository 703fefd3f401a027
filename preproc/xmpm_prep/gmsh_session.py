"""gmsh for the length of a `with` block, quiet, its complaints as PrepError."""

import os
import sys
from contextlib import contextmanager
from pathlib import Path

from xmpm_prep.errors import FILES, PrepError


@contextmanager
def gmsh_session():
    """The gmsh module with an empty model; what gmsh cannot do ends as one line."""
    import gmsh

    gmsh.initialize(["xmpm-prep"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.AbortOnError", 2)  # raise, do not go on
        gmsh.logger.start()
        yield gmsh
    except PrepError:
        raise
    except Exception as failure:  # gmsh raises plain Exception
        raise PrepError(f"gmsh: {_reason(gmsh, failure)}") from None
    finally:
        gmsh.finalize()


def open_in_gmsh(gmsh, path):
    """Open any file that gmsh knows: .geo, .step, .brep, .iges, .msh."""
    if str(path).endswith(".geo"):
        _check_last_line(path)
    try:
        with _quiet():
            gmsh.open(str(path))
    except Exception as failure:
        raise PrepError(f"{path}: gmsh cannot read it: {_reason(gmsh, failure)}", FILES) from None


def _check_last_line(path):
    """Refuse what gmsh reads in part: of a last line that does not end, the first statement."""
    with Path(path).open(encoding="utf-8", errors="replace") as file:
        last = file.read().rpartition("\n")[2]
    if last.strip().rstrip(";").count(";"):
        raise PrepError(
            f"{path}: the last line holds several statements and no end of line; gmsh would read "
            "the first alone: add an empty line",
            FILES,
        )


@contextmanager
def _quiet():
    """Nothing on standard output from libraries: OpenCASCADE writes there what we say anyway."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def _reason(gmsh, failure):
    """The first error that gmsh logged, or what it raised."""
    for line in gmsh.logger.get():
        kind, _, text = line.partition(": ")
        if kind == "Error":
            return text
    return str(failure) or "unknown error"
