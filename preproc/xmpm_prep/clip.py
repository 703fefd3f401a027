"""Surface triangles cut along the planes of a lattice, and what lies below them cell by cell.

Coordinates are in units of cells, so that cell i fills i to i + 1. Polygons are padded by
repeating a vertex, which adds no area.
"""

from dataclasses import dataclass

import numpy as np

from xmpm_prep.progress import progress

BATCH = 100_000  # pieces that are worked on at a time, about


@dataclass
class Pieces:
    """Pieces of surface triangles, each inside one cell, with integrals over the piece.

    `flux` is of 1, x, y, z, x z, y z, z**2 / 2 times the z component of the normal, with x, y, z
    from the cell's lower corner: what the divergence theorem needs.
    """

    cell: np.ndarray  # (n,3) the cell
    triangle: np.ndarray  # (n) number of the triangle
    area: np.ndarray  # (n,3) area vector
    centroid: np.ndarray  # (n,3) of the piece
    flux: np.ndarray  # (n,7)


def cut_triangles(points, triangles, text="cutting the surface"):
    """All pieces of triangles; a piece in a lattice plane goes to the cell behind its normal."""
    corners = points[triangles]
    batches = []
    for first, last in progress(_batches(corners), text):
        batches.append(_cut_batch(corners[first:last], first))
    if not batches:
        batches = [_cut_batch(corners, 0)]
    return Pieces(
        *(
            np.concatenate([getattr(batch, name) for batch in batches])
            for name in Pieces.__dataclass_fields__
        )
    )


def snap(points, tolerance):
    """Points with coordinates that are nearly integers made integers."""
    near = np.rint(points)
    return np.where(np.abs(points - near) <= tolerance, near, points)


def _batches(corners):
    """Ranges of triangles with about the same number of pieces."""
    edges = np.roll(corners, -1, axis=1) - corners
    expected = 1 + np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    expected += np.abs(edges).sum(axis=(1, 2))
    group = (np.cumsum(expected) // BATCH).astype(int)
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    return list(zip(starts, [*starts[1:], len(corners)], strict=True))


def _cut_batch(corners, first):
    triangle = np.arange(len(corners))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cell = np.zeros((len(corners), 3), np.int64)
    polygons = corners
    for axis in range(3):
        polygons, chosen, place = _cut_along(polygons, normal[triangle, axis], axis)
        triangle = triangle[chosen]
        cell = cell[chosen]
        cell[:, axis] = place
    return _measure(polygons, cell, triangle, first)


def _cut_along(polygons, normal, axis):
    """Cut polygons by all planes across an axis: pieces, the polygon of each, its slab."""
    value = polygons[:, :, axis]
    low, high = value.min(axis=1), value.max(axis=1)
    first = np.floor(low).astype(np.int64)
    count = np.ceil(high).astype(np.int64) - first
    flat = count == 0  # in a lattice plane: the material lies behind the normal
    first -= flat & (normal > 0)
    count += flat
    chosen = np.repeat(np.arange(len(polygons)), count)
    place = np.arange(len(chosen)) - np.repeat(np.cumsum(count) - count, count) + first[chosen]
    pieces = polygons[chosen]
    cut = count[chosen] > 1
    if not cut.any():
        return pieces, chosen, place
    some = pieces[cut]
    some = _clip(some, axis, place[cut], 1.0)
    some = _clip(some, axis, place[cut] + 1, -1.0)
    wide = np.empty((len(pieces), some.shape[1], 3))
    wide[:, : pieces.shape[1]] = pieces
    wide[:, pieces.shape[1] :] = pieces[:, -1:]
    wide[cut] = some
    return wide, chosen, place


def _clip(polygons, axis, plane, sign):
    """Convex polygons cut off at planes across an axis; what lies on the side `sign` is kept."""
    n, width, _ = polygons.shape
    height = sign * (polygons[:, :, axis] - plane[:, None])
    inside = height >= 0
    following = np.roll(height, -1, axis=1)
    crosses = ((height > 0) & (following < 0)) | ((height < 0) & (following > 0))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(crosses, height / (height - following), 0.0)
    crossing = polygons + part[:, :, None] * (np.roll(polygons, -1, axis=1) - polygons)
    crossing[:, :, axis] = plane[:, None]
    emitted = np.stack([polygons, crossing], axis=2).reshape(n, 2 * width, 3)
    kept = np.stack([inside, crosses], axis=2).reshape(n, 2 * width)
    # The kept ones in front, in their order; behind them the last one again.
    order = np.argsort(~kept, axis=1, kind="stable")[:, : width + 1]
    last = np.maximum(kept.sum(axis=1) - 1, 0)
    order = np.take_along_axis(order, np.minimum(np.arange(width + 1), last[:, None]), axis=1)
    return np.take_along_axis(emitted, order[:, :, None], axis=1)


def _measure(polygons, cell, triangle, first):
    """Integrals over polygons, each as a fan of triangles around its first vertex."""
    local = polygons - cell[:, None, :]
    n = len(local)
    area = np.zeros((n, 3))
    size = np.zeros(n)
    weighted = np.zeros((n, 3))
    flux = np.zeros((n, 7))
    a = local[:, 0]
    for i in range(1, local.shape[1] - 1):
        b, c = local[:, i], local[:, i + 1]
        part = np.cross(b - a, c - a) / 2
        norm = np.linalg.norm(part, axis=1)
        area += part
        size += norm
        weighted += norm[:, None] * (a + b + c) / 3
        for middle in ((a + b) / 2, (b + c) / 2, (c + a) / 2):  # exact for quadratic functions
            x, y, z = middle.T
            values = np.column_stack([np.ones(n), x, y, z, x * z, y * z, z * z / 2])
            flux += values * (part[:, 2:] / 3)
    solid = size > 0
    centroid = local.mean(axis=1)
    centroid[solid] = weighted[solid] / size[solid, None]
    return Pieces(
        cell[solid],
        triangle[solid] + first,
        area[solid],
        (centroid + cell)[solid],
        flux[solid],
    )
