"""The body around a crack: which points lie in it, from a particle file or from a model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from xmpm_prep.crack_front import Inside
from xmpm_prep.errors import FILES, PrepError

# A point nearer to a particle, by each coordinate, lies in the body [edge of the largest cube].
LATTICE, SCATTERED = 0.51, 0.8


@dataclass(frozen=True)
class BodyShape:
    """What a crack needs to know of its body."""

    path: Path
    inside: Inside
    low: np.ndarray  # corners of its bounding box
    high: np.ndarray
    unit: str | None  # of length, where the file states it


def read_body(path, part: str | None, h: float) -> BodyShape:
    """A body from a particle file (.h5) or from what `xmpm-prep particles` reads."""
    from xmpm_prep.files import input_file

    path = input_file(path)
    if path.suffix.lower() in (".h5", ".hdf5"):
        return read_particles(path, part)
    return read_solid(path, part, h)


def read_solid(path: Path, part: str | None, h: float) -> BodyShape:
    """A body from geometry, a mesh or a closed surface."""
    from xmpm_prep.inside import is_inside
    from xmpm_prep.model import choose, read_model

    model = choose(read_model(path, h), [part] if part else None)
    used = np.unique(np.concatenate([body.triangles for body in model.bodies]))

    def inside(points: np.ndarray) -> np.ndarray:
        found = np.zeros(len(points), dtype=bool)
        for body in model.bodies:
            found |= is_inside(points, model.points, body.triangles)
        return found

    points = model.points[used]
    return BodyShape(path, inside, points.min(axis=0), points.max(axis=0), model.unit)


def read_particles(path: Path, part: str | None) -> BodyShape:
    """A body as the cubes around its particles."""
    import h5py

    try:
        with h5py.File(path) as file:
            if file.attrs.get("format") != "xmpm3d particles":
                raise PrepError(f"{path}: it is no particle file", FILES)
            unit = file.attrs.get("length_unit")
            points, volumes = file["positions"][:], file["volumes"][:]
            if part is not None:
                names = [text.decode() for text in file["body_names"]] if "bodies" in file else []
                if part not in names:
                    known = ", ".join(names) or "none"
                    raise PrepError(f"{path}: there is no body '{part}'; it has: {known}")
                mine = file["bodies"][:] == names.index(part)
                points, volumes = points[mine], volumes[mine]
    except (OSError, KeyError) as failure:
        raise PrepError(f"{path}: it cannot be read: {failure}", FILES) from None
    edge = float(np.cbrt(volumes.max()))
    same = np.mean(volumes > 0.99 * volumes.max())
    reach = edge * (LATTICE if same > 0.3 else SCATTERED)
    tree = cKDTree(points)

    def inside(queries: np.ndarray) -> np.ndarray:
        return tree.query(queries, p=np.inf, distance_upper_bound=reach)[0] < np.inf

    half = 0.5 * edge
    return BodyShape(path, inside, points.min(axis=0) - half, points.max(axis=0) + half, unit)
