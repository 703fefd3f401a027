"""Triangles of gmsh surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from xmpm_prep.crack_surface import Surface, drop_unused
from xmpm_prep.errors import PrepError

MOST = 1e6  # squares of the wanted size in that of the crack's extent
METHODS = (6, 5, 1)  # gmsh's Frontal-Delaunay, Delaunay, MeshAdapt: tried until the angle suits


def set_size(gmsh: Any, size: float) -> None:
    """One size of triangles everywhere, whatever the model says."""
    for name in ("MeshSizeMin", "MeshSizeMax"):
        gmsh.option.setNumber(f"Mesh.{name}", size)
    for name, value in (
        ("MeshSizeFromPoints", 0),
        ("MeshSizeFromCurvature", 0),
        ("MeshSizeExtendFromBoundary", 0),
        ("MeshSizeFactor", 1),
        ("ElementOrder", 1),
        ("RecombineAll", 0),
        ("SubdivisionAlgorithm", 0),
        ("RandomSeed", 1),
    ):
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.model.mesh.removeConstraints()
    for field in gmsh.model.mesh.field.list():
        gmsh.model.mesh.field.remove(field)


def mesh_surfaces(gmsh: Any, tags: list[int], size: float, angle: float) -> Surface:
    """Mesh some surfaces of gmsh's current model, and no others.

    Of gmsh's methods the first is taken whose smallest angle reaches `angle`, else the best.
    """
    check_size(gmsh, tags, size)
    gmsh.model.setVisibility(gmsh.model.getEntities(), 0)
    gmsh.model.setVisibility([(2, tag) for tag in tags], 1, recursive=True)
    gmsh.option.setNumber("Mesh.MeshOnlyVisible", 1)
    set_size(gmsh, size)
    best, best_angle = None, -1.0
    for method in METHODS:
        gmsh.option.setNumber("Mesh.Algorithm", method)
        gmsh.model.mesh.clear()
        gmsh.model.mesh.generate(2)
        surface = triangles_of(gmsh, tags)
        smallest = float(surface.angles.min())
        if smallest > best_angle:
            best, best_angle = surface, smallest
        if best_angle >= angle:
            break
    return best


def check_size(gmsh: Any, tags: list[int], size: float) -> None:
    """The size must suit the surfaces, else meshing would take all day or make nothing of them."""
    boxes = np.array([gmsh.model.getBoundingBox(2, tag) for tag in tags])
    extent = float((boxes[:, 3:].max(axis=0) - boxes[:, :3].min(axis=0)).max())
    if size > extent:
        raise PrepError(
            f"triangles of size {size:g} are larger than the whole crack, which is {extent:.6g} "
            "long: mixed units?"
        )
    if (extent / size) ** 2 > MOST:
        raise PrepError(
            f"triangles of size {size:g} on a crack that is {extent:.6g} long would be about "
            f"{2 * (extent / size) ** 2:.0e}: mixed units?"
        )


def triangles_of(gmsh: Any, tags: list[int]) -> Surface:
    """The triangles that surfaces of gmsh's current model have, as their normals run."""
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    triangles = []
    for tag in tags:
        kinds, _, nodes = gmsh.model.mesh.getElements(2, tag)
        for kind, found in zip(kinds, nodes, strict=True):
            _, _, _, count, _, corners = gmsh.model.mesh.getElementProperties(kind)
            found = np.asarray(found).reshape(-1, count)[:, :corners]
            triangles.append(found[:, :3])
            if corners == 4:
                triangles.append(found[:, [0, 2, 3]])
    if not triangles:
        raise PrepError("there are no triangles on the surface")
    numbered = np.searchsorted(numbers[order], np.concatenate(triangles))
    return drop_unused(Surface(coordinates.reshape(-1, 3)[order], numbered))
