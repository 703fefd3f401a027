"""Closed surfaces of triangles: welded, checked, turned outward, measured."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components
from scipy.spatial import cKDTree

from xmpm_prep.errors import PrepError


def triangle_areas(points, triangles):
    """Area vectors (n,3) of triangles."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2


def enclosed_volume(points, triangles):
    """Volume inside a closed surface whose normals point outward."""
    if len(triangles) == 0:
        return 0.0
    origin = points[triangles[0, 0]]  # near the body: little to cancel
    centroid = points[triangles].mean(axis=1) - origin
    return float(np.einsum("ij,ij->", centroid, triangle_areas(points, triangles)) / 3)


def weld(points, triangles, tolerance):
    """Points nearer to each other than a tolerance made one; triangles that vanish are left out."""
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    _, group = connected_components(graph, directed=False)
    _, first, group = np.unique(group, return_index=True, return_inverse=True)
    triangles = group[triangles]
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)
    return points[first], triangles[kept], kept


def check_closed(points, triangles, what):
    """Raise where an edge belongs to one triangle, or to an odd number of them."""
    edges = np.sort(_edges(triangles), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    odd = unique[count % 2 == 1]
    if len(odd):
        place = ", ".join(f"{value:.6g}" for value in points[odd[0]].mean(axis=0))
        raise PrepError(
            f"{what}: the surface is not closed: {len(odd)} edges belong to an odd number of "
            f"triangles, the first near ({place})"
        )


def turn_outward(points, triangles):
    """Triangles with their normals out of the material, and how many had to be turned.

    Triangles of one part are first made to agree over common edges; then each part gets its normals
    outward, or inward where it lies inside an odd number of others: it is a cavity.
    """
    turned = ~_agreement(triangles)
    result = np.where(turned[:, None], triangles[:, ::-1], triangles)
    part = _parts_of(triangles)
    depth = _depths(points, result, part)
    for number in range(len(depth)):
        volume = enclosed_volume(points, result[part == number])
        if (volume < 0) != (depth[number] % 2 == 1):
            mine = part == number
            result[mine] = result[mine][:, ::-1]
            turned[mine] = ~turned[mine]
    return result, int(turned.sum())


def is_consistent(triangles):
    """Whether triangles run against each other along all common edges."""
    edges = _edges(triangles)
    n = int(triangles.max(initial=0)) + 1
    forth, back = edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0]
    return np.array_equal(np.sort(forth), np.sort(back))


def _edges(triangles):
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _neighbours(triangles):
    """Pairs of triangles at a common edge of two, and whether they run in the same direction."""
    edges = _edges(triangles)
    owner = np.tile(np.arange(len(triangles)), 3)
    low, high = edges.min(axis=1), edges.max(axis=1)
    order = np.lexsort((high, low))
    low, high, owner = low[order], high[order], owner[order]
    forward = (edges[:, 0] < edges[:, 1])[order]
    new = np.concatenate([[True], (np.diff(low) != 0) | (np.diff(high) != 0)])
    start = np.flatnonzero(new)
    two = start[np.diff([*start, len(low)]) == 2]
    return owner[two], owner[two + 1], forward[two] == forward[two + 1]


def _parts_of(triangles):
    """Number of the part (joined over edges of two) of each triangle."""
    a, b, _ = _neighbours(triangles)
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(len(triangles),) * 2)
    return connected_components(graph, directed=False)[1]


def _agreement(triangles):
    """Which triangles stay as they are for all to agree with the first of their part."""
    stay = np.ones(len(triangles), bool)
    a, b, against = _neighbours(triangles)
    if not against.any():
        return stay
    # Weights 1 and 2 tell agreeing from disagreeing neighbours; follow a tree through each part.
    n = len(triangles)
    graph = coo_matrix((1.0 + against, (a, b)), shape=(n, n)).tocsr()
    graph = (graph + graph.T).tocsr()
    _, part = connected_components(graph, directed=False)
    for root in np.unique(part, return_index=True)[1]:
        order, parent = breadth_first_order(graph, root, directed=False)
        weight = np.asarray(graph[parent[order[1:]], order[1:]]).ravel()
        for child, mother, value in zip(
            order[1:].tolist(), parent[order[1:]].tolist(), weight.tolist(), strict=True
        ):
            stay[child] = stay[mother] == (value < 1.5)
    return stay


def _depths(points, triangles, part):
    """In how many other parts each part lies."""
    from xmpm_prep.inside import is_inside

    n = part.max(initial=-1) + 1
    depth = np.zeros(n, int)
    if n < 2:
        return depth
    chosen = [triangles[part == number] for number in range(n)]
    bounds = [(points[t].min(axis=(0, 1)), points[t].max(axis=(0, 1))) for t in chosen]
    for inner in range(n):
        some = chosen[inner][:: max(1, len(chosen[inner]) // 100)]
        middles = points[some].mean(axis=1)
        for outer in range(n):
            low, high = bounds[outer]
            if inner == outer or np.any(middles < low) or np.any(middles > high):
                continue
            depth[inner] += int(is_inside(middles, points, chosen[outer]).all())
    return depth
