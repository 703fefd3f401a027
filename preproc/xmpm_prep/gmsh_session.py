"""gmsh for the length of a `with` block, quiet, its complaints as PrepError."""

from contextlib import contextmanager

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
    try:
        gmsh.open(str(path))
    except Exception as failure:
        raise PrepError(f"{path}: gmsh cannot read it: {_reason(gmsh, failure)}", FILES) from None


def _reason(gmsh, failure):
    """The first error that gmsh logged, or what it raised."""
    for line in gmsh.logger.get():
        kind, _, text = line.partition(": ")
        if kind == "Error":
            return text
    return str(failure) or "unknown error"
