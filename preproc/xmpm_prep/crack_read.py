"""Crack surfaces from files: geometry and meshes of gmsh, STL, OFF, VTK, our own crack files."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from xmpm_prep.crack_mesh import mesh_surfaces, triangles_of
from xmpm_prep.crack_surface import Surface, drop_unused, merge_points
from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.files import input_file
from xmpm_prep.gmsh_session import gmsh_session, open_in_gmsh

GEOMETRY = {".geo", ".geo_unrolled", ".step", ".stp", ".brep", ".iges", ".igs", ".xao"}
SAME = 1e-6  # of the extent: corners nearer to each other are one, as the program reads STL


def read_surface(path, name: str | None, size: float, angle: float) -> tuple[Surface, bool, bool]:
    """A surface from a file; whether it has the wanted size; whether the file has a volume too."""
    path = input_file(path)
    ending = path.suffix.lower()
    if ending in GEOMETRY or ending == ".msh":
        return read_with_gmsh(path, name, size, angle)
    if name is not None:
        raise PrepError(f"{path}: --name chooses a physical surface of gmsh; this file has none")
    if ending in (".h5", ".hdf5"):
        surface = read_crack(path)
    elif ending == ".vtp":
        surface = read_with_vtk(path)
    else:
        surface = read_with_meshio(path)
    if len(surface.triangles) == 0:
        raise PrepError(f"{path}: there are no triangles in it", FILES)
    if not np.isfinite(surface.points).all():
        raise PrepError(f"{path}: a vertex has a coordinate that is not finite", FILES)
    surface = drop_unused(surface)
    return merge_points(surface, SAME * surface.extent), False, False


# --- gmsh -------------------------------------------------------------------------------------


def read_with_gmsh(path: Path, name: str | None, size: float, angle: float):
    """A physical surface, or the surfaces that bound no volume."""
    with gmsh_session() as gmsh:
        open_in_gmsh(gmsh, path)
        if path.suffix.lower() in GEOMETRY:
            gmsh.model.occ.synchronize()
        tags = choose_surfaces(gmsh, path, name)
        has_volume = bool(gmsh.model.getEntities(3))
        if path.suffix.lower() != ".msh":
            return mesh_surfaces(gmsh, tags, size, angle), True, has_volume
        surface = triangles_of(gmsh, tags)
    return merge_points(surface, SAME * surface.extent), False, has_volume


def choose_surfaces(gmsh: Any, path: Path, name: str | None) -> list[int]:
    """Tags of the surfaces of a physical name, else of those that no volume has for a face."""
    groups = {}
    for _, group in gmsh.model.getPhysicalGroups(2):
        key = gmsh.model.getPhysicalName(2, group).strip() or f"surface_{group}"
        found = gmsh.model.getEntitiesForPhysicalGroup(2, group)
        groups.setdefault(key, set()).update(int(tag) for tag in found)
    known = f"its physical surfaces are: {', '.join(groups) or 'none'}"
    if name is not None:
        if name not in groups:
            raise PrepError(f"{path}: there is no physical surface '{name}'; {known}")
        return sorted(groups[name])
    faces = {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(3), False, False)}
    loose = {tag for _, tag in gmsh.model.getEntities(2)} - faces
    named = {key: tags for key, tags in groups.items() if tags <= loose}
    if "crack" in groups:
        return sorted(groups["crack"])
    if len(named) == 1:
        return sorted(next(iter(named.values())))
    if len(named) > 1:
        raise PrepError(f"{path}: which surface is the crack? Choose by --name; {known}")
    if not loose:
        what = "all its surfaces bound volumes" if faces else "it has no surface"
        raise PrepError(f"{path}: {what}; a crack is a surface of its own ({known})")
    return sorted(loose)


# --- others ---------------------------------------------------------------------------------------


def read_with_meshio(path: Path) -> Surface:
    """Triangles, and quadrangles in two, of a file that meshio reads; VTK helps with its own."""
    import meshio

    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            mesh = meshio.read(path)
    except (Exception, SystemExit) as failure:  # it has exceptions of every kind, and exits
        if path.suffix.lower() == ".vtk":
            return read_with_vtk(path)
        reason = " ".join(str(failure).split()) or type(failure).__name__
        raise PrepError(f"{path}: it cannot be read: {reason}", FILES) from None
    triangles = [np.zeros((0, 3), dtype=np.intp)]
    for block in mesh.cells:
        data = np.asarray(block.data)
        if block.type.startswith("triangle"):
            triangles.append(data[:, :3])
        elif block.type.startswith("quad"):
            triangles += [data[:, :3], data[:, [0, 2, 3]]]
    points = np.asarray(mesh.points, dtype=float)
    points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    triangles = np.concatenate(triangles).astype(np.intp)
    if triangles.size and not 0 <= triangles.min() <= triangles.max() < len(points):
        raise PrepError(f"{path}: a triangle names a vertex that is not there", FILES)
    return Surface(points, triangles)


def read_with_vtk(path: Path) -> Surface:
    """Triangles of any data set of VTK."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkObject

    vtkObject.GlobalWarningDisplayOff()
    try:
        mesh = pyvista.read(path).extract_surface(algorithm=None).triangulate()
        triangles = mesh.faces.reshape(-1, 4)[:, 1:] if mesh.n_cells else np.zeros((0, 3), int)
        return Surface(np.array(mesh.points, dtype=float), np.array(triangles, dtype=np.intp))
    except Exception as failure:
        reason = " ".join(str(failure).split()) or type(failure).__name__
        raise PrepError(f"{path}: it cannot be read: {reason}", FILES) from None
    finally:
        vtkObject.GlobalWarningDisplayOn()


def read_crack(path: Path) -> Surface:
    """Triangles of a crack file of ours."""
    import h5py

    try:
        with h5py.File(path) as file:
            if file.attrs.get("format") != "xmpm3d crack":
                raise PrepError(f"{path}: it is no crack file", FILES)
            return Surface(file["vertices"][:].astype(float), file["triangles"][:].astype(np.intp))
    except (OSError, KeyError) as failure:
        raise PrepError(f"{path}: it cannot be read: {failure}", FILES) from None
