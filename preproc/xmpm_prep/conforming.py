"""Particles at the middles of equal parts of a mesh's tetrahedra and hexahedra.

An element of about k**3 particle volumes is divided into k**3 parts: a tetrahedron into ones of the
same volume, a hexahedron along its own coordinates. A part is a particle with its volume at its
centroid, so that the volume of the mesh is kept to rounding.
"""

from itertools import permutations

import numpy as np
from scipy.spatial import cKDTree

from xmpm_prep.cloud import Cloud, make_patch
from xmpm_prep.elements import element_volumes

GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)  # exact for the volume and moment of a brick


def fill_mesh(model, body, spacing):
    """The particles of a body in its volume mesh, of about the volume `spacing`**3 each."""
    positions, volumes = [np.zeros((0, 3))], [np.zeros(0)]
    for kind, ids in body.cells.items():
        whole = element_volumes(model.points, kind, ids)
        parts = np.maximum(1, np.rint(np.cbrt(whole / spacing**3))).astype(int)
        for k in np.unique(parts):
            corners = model.points[ids[parts == k]]
            fill = _tetrahedra if kind == "tetra" else _hexahedra
            some, volume = fill(corners, k)
            positions.append(some)
            volumes.append(volume)
    cloud = Cloud(np.concatenate(positions), np.concatenate(volumes))
    tree = cKDTree(cloud.positions) if body.sets else None
    for name, rows in body.sets.items():
        cloud.sets[name] = _patch(model, body.triangles[rows], spacing, cloud, tree)
    return cloud


def _tetrahedra(corners, k):
    """Middles and volumes of k**3 equal parts of tetrahedra (n,4,3)."""
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.linalg.det(edges) / 6
    places = _middles(k)
    positions = corners[:, :1] + np.einsum("mi,nij->nmj", places, edges)
    return positions.reshape(-1, 3), np.repeat(volume / k**3, k**3)


def _middles(k):
    """Middles (k**3,3) of the parts of the tetrahedron with corners 0 and the unit vectors.

    The tetrahedron 1 >= x >= y >= z >= 0 is cut by the planes of a grid into cubes, each made of
    six such tetrahedra; those inside it are kept.
    """
    found = []
    for cube in np.ndindex(k, k, k):
        for order in permutations(range(3)):
            corner = np.array([cube] * 4, float)
            for step, axis in enumerate(order):
                corner[step + 1 :, axis] += 1
            middle = corner.mean(axis=0)
            if middle[0] > middle[1] > middle[2]:
                found.append(middle / k)
    x, y, z = np.array(found).T
    return np.column_stack([x - y, y - z, z])


def _hexahedra(corners, k):
    """Middles and volumes of k**3 parts of hexahedra (n,8,3)."""
    positions, volumes = [], []
    for cell in np.ndindex(k, k, k):
        volume = np.zeros(len(corners))
        moment = np.zeros((len(corners), 3))
        for u in np.ndindex(2, 2, 2):
            place = (np.array(cell) + GAUSS[list(u)]) / k
            values, slopes = _brick(place)
            size = np.linalg.det(np.einsum("ai,naj->nij", slopes, corners)) / (8 * k**3)
            volume += size
            moment += size[:, None] * np.einsum("a,naj->nj", values, corners)
        positions.append(moment / volume[:, None])
        volumes.append(volume)
    return np.stack(positions, axis=1).reshape(-1, 3), np.stack(volumes, axis=1).ravel()


def _brick(place):
    """Shape functions (8) of a hexahedron at a place in the unit cube, and their slopes (8,3)."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corner = np.concatenate([corner, corner + np.array([0, 0, 1])])
    factor = np.where(corner == 1, place, 1 - place)
    sign = np.where(corner == 1, 1.0, -1.0)
    slopes = np.stack(
        [sign[:, i] * factor[:, (i + 1) % 3] * factor[:, (i + 2) % 3] for i in range(3)], axis=1
    )
    return factor.prod(axis=1), slopes


def _patch(model, triangles, spacing, cloud, tree):
    """Triangles of a surface in parts no larger than a particle, each to the nearest below it."""
    corners = model.points[triangles]
    edge = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    k = np.maximum(1, np.ceil(edge / spacing)).astype(int)
    area, centre = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for count in np.unique(k):
        some = corners[k == count]
        edges = some[:, 1:] - some[:, :1]
        whole = np.cross(edges[:, 0], edges[:, 1]) / 2
        i, j = np.indices((count, count)).reshape(2, -1)
        up = (np.column_stack([i, j]) + 1 / 3)[i + j < count]
        down = (np.column_stack([i, j]) + 2 / 3)[i + j < count - 1]
        places = np.concatenate([up, down]) / count
        centre.append((some[:, :1] + np.einsum("mi,nij->nmj", places, edges)).reshape(-1, 3))
        area.append(np.repeat(whole / count**2, count**2, axis=0))
    area, centre = np.concatenate(area), np.concatenate(centre)
    size = np.maximum(np.linalg.norm(area, axis=1, keepdims=True), np.finfo(float).tiny)
    particle = tree.query(centre - spacing / 4 * area / size)[1]
    return make_patch(cloud.positions, particle, area, centre)
