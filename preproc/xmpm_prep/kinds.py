"""Which kind of file of ours a path is."""

import h5py

from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.files import input_file

KINDS = {"xmpm3d particles": "particles", "xmpm3d crack": "crack"}


def kind_of(path):
    """`particles` or `crack`."""
    path = input_file(path)
    try:
        with h5py.File(path, "r") as file:
            word = file.attrs.get("format")
    except OSError:
        raise PrepError(f"{path}: not a readable HDF5 file", FILES) from None
    if word not in KINDS:
        raise PrepError(
            f"{path}: the format is '{word}'; expected is one of: {', '.join(KINDS)}", FILES
        )
    return KINDS[word]


def sort_files(paths):
    """Particle files and crack files, each in the order given."""
    found = {"particles": [], "crack": []}
    for path in paths:
        found[kind_of(path)].append(path)
    return found["particles"], found["crack"]


def unit_of(path):
    """Unit of length that a file of ours states."""
    kind_of(path)
    with h5py.File(path, "r") as file:
        return str(file.attrs.get("length_unit", ""))
