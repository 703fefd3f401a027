"""A model as all commands see it, whatever file it comes from.

`read_model(path)` reads geometry (.geo, .step, .brep, .iges: through gmsh), volume meshes (.msh
through gmsh, all others through meshio) and closed surfaces (.stl and other meshes of triangles
alone, where `surfaces_too`).
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from xmpm_prep.errors import PrepError
from xmpm_prep.surface import enclosed_volume

GEOMETRY = {".geo", ".geo_unrolled", ".step", ".stp", ".brep", ".iges", ".igs", ".xao"}


@dataclass
class Body:
    """A body of a model: a closed surface with named parts, and a volume mesh if there is one."""

    name: str
    material: str
    triangles: np.ndarray  # (t,3) rows of the model's points, normals outward
    sets: dict[str, np.ndarray] = field(default_factory=dict)  # name: rows of `triangles`
    volume: float = 0.0  # of the model itself: geometry, not its triangles
    cells: dict[str, np.ndarray] = field(default_factory=dict)  # tetra (n,4), hexahedron (n,8)


@dataclass
class Model:
    """What a model file holds."""

    path: Path
    points: np.ndarray  # (n,3) [length]
    bodies: list[Body]
    unit: str | None = None  # that the file itself states
    source: str = "geometry"  # geometry, mesh or surface
    notes: list[str] = field(default_factory=list)  # what a user should hear of

    @property
    def set_names(self):
        """Names of all sets, in order."""
        return sorted({name for body in self.bodies for name in body.sets})

    def enclosed(self, body):
        """Volume inside the triangles of a body."""
        return enclosed_volume(self.points, body.triangles)


def read_model(path, cell=None, mesh_size=None, all_faces=False):
    """Read a model.

    `cell` is the edge of the grid's cells, which a curved surface is to follow closely; `mesh_size`
    asks for a volume mesh of geometry with elements of that size; `all_faces` makes every surface
    of geometry a set, named or not.
    """
    from xmpm_prep import read_geometry, read_mesh
    from xmpm_prep.files import input_file

    path = input_file(path)
    ending = path.suffix.lower()
    if ending in GEOMETRY:
        return read_geometry.read(path, cell, mesh_size, all_faces)
    if ending == ".msh":
        return read_mesh.read_msh(path)
    if ending == ".stl":
        return read_mesh.read_surface(path)
    return read_mesh.read_any(path)


def split_name(name):
    """Body and material of a physical name: `wheel:steel`, or the same word for both."""
    body, _, material = name.partition(":")
    body = body.strip()
    return body, material.strip() or body


def choose(model, bodies=None, sets=None):
    """Keep the bodies and sets of these names; raise where one is unknown."""
    for kind, wanted, known in (
        ("body", bodies, [body.name for body in model.bodies]),
        ("set", sets, model.set_names),
    ):
        for name in wanted or ():
            if name not in known:
                raise PrepError(
                    f"{model.path}: there is no {kind} of the name '{name}'; it has: "
                    f"{', '.join(known) or 'none'}"
                )
    if bodies:
        model.bodies = [body for body in model.bodies if body.name in bodies]
    for body in model.bodies if sets is not None else ():
        body.sets = {name: rows for name, rows in body.sets.items() if name in sets}
    return model
