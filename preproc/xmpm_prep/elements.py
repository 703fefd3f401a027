"""Volume elements: their faces, volumes, outer surface, and their split into tetrahedra.

Nodes are numbered as gmsh does. Elements of higher order are taken by their corners, save
tetrahedra of ten nodes, which become eight.
"""

import numpy as np

FACES = {  # outward
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": (
        (0, 3, 2, 1),
        (4, 5, 6, 7),
        (0, 1, 5, 4),
        (1, 2, 6, 5),
        (2, 3, 7, 6),
        (3, 0, 4, 7),
    ),
}
MIRRORED = {  # the same element, inside out
    "tetra": (0, 2, 1, 3),
    "pyramid": (0, 3, 2, 1, 4),
    "wedge": (3, 4, 5, 0, 1, 2),
    "hexahedron": (4, 5, 6, 7, 0, 1, 2, 3),
}
SPLIT = {  # into tetrahedra
    "tetra": ((0, 1, 2, 3),),
    "pyramid": ((0, 1, 2, 4), (0, 2, 3, 4)),
    "wedge": ((0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5)),
}
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))  # of a tetrahedron; node 4 + i is on i
EIGHT = (
    (0, 4, 6, 7),
    (4, 1, 5, 8),
    (6, 5, 2, 9),
    (7, 8, 9, 3),
    (4, 5, 6, 8),
    (4, 6, 7, 8),
    (5, 6, 8, 9),
    (6, 7, 8, 9),
)
CORNERS = {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron"}


def corner_count(kind):
    """Corners of an element by meshio's name of it, 0 for what is no volume element."""
    for corners, name in CORNERS.items():
        if kind.startswith(name):
            return corners
    return 0


def face_volume(points, face):
    """Volume between faces (n, 3 or 4) and the origin; bilinear where there are four corners."""
    p = [points[face[:, i]] for i in range(face.shape[1])]
    if len(p) == 3:
        return np.einsum("ij,ij->i", p[0], np.cross(p[1], p[2])) / 6
    halves = ((0, 1, 2), (0, 2, 3)), ((0, 1, 3), (1, 2, 3))
    return sum(
        np.einsum("ij,ij->i", p[a], np.cross(p[b], p[c])) / 12
        for half in halves
        for a, b, c in half
    )


def element_volumes(points, kind, ids):
    """Volumes of elements by their corners; faces of four corners are bilinear."""
    local = points[ids] - points[ids[:, :1]]  # from a corner: nothing large cancels
    flat = local.reshape(-1, 3)
    numbers = np.arange(len(flat)).reshape(ids.shape)
    return sum((face_volume(flat, numbers[:, face]) for face in FACES[kind]), np.zeros(len(ids)))


def right_way_round(points, kind, ids):
    """Elements with those inside out mirrored."""
    wrong = element_volumes(points, kind, ids) < 0
    result = ids.copy()
    result[wrong] = ids[wrong][:, MIRRORED[kind]]
    return result


def outer_faces(blocks):
    """Faces (n,4) that belong to one element alone, outward; a triangle ends with -1.

    `blocks` are pairs of a kind and corners (n,k).
    """
    found = [np.zeros((0, 4), np.int64)]
    for kind, ids in blocks:
        for face in FACES[kind]:
            some = np.full((len(ids), 4), -1, np.int64)
            some[:, : len(face)] = ids[:, face]
            found.append(some)
    faces = np.concatenate(found)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(first[count == 1])]


def match_faces(outer, wanted):
    """Rows of `outer` (n,4) that have the same corners as some of `wanted` (m, 3 or 4)."""
    padded = np.full((len(wanted), 4), -1, np.int64)
    padded[:, : wanted.shape[1]] = wanted
    every = np.sort(np.concatenate([outer, padded]), axis=1)
    _, group = np.unique(every, axis=0, return_inverse=True)
    group = group.ravel()
    return np.flatnonzero(np.isin(group[: len(outer)], group[len(outer) :]))


def middle_nodes(ids):
    """Edges of ten-node tetrahedra (n,2), sorted, and the node on each."""
    edges = np.concatenate([ids[:, list(edge)] for edge in EDGES])
    edges = np.sort(edges, axis=1)
    middles = np.concatenate([ids[:, 4 + i] for i in range(6)])
    edges, first = np.unique(edges, axis=0, return_index=True)
    return edges, middles[first]


def triangulate(points, faces, edges, middles):
    """Triangles of outer faces, the face of each, and the points with new ones behind.

    A triangle with nodes on its edges becomes four, a face of four corners four around its middle.
    """
    triangle = faces[:, 3] < 0
    rows = np.flatnonzero(triangle)
    corners = faces[rows, :3]
    owner, found = [], []
    curved = np.zeros(len(rows), bool)
    if len(edges):
        n = int(edges.max()) + 1 if len(edges) else 1
        n = max(n, int(corners.max(initial=0)) + 1)
        keys = edges[:, 0] * n + edges[:, 1]
        place = []
        for i, j in ((0, 1), (1, 2), (2, 0)):
            low, high = np.sort(corners[:, [i, j]], axis=1).T
            at = np.minimum(np.searchsorted(keys, low * n + high), len(keys) - 1)
            place.append(np.where(keys[at] == low * n + high, at, -1))
        place = np.stack(place, axis=1)
        curved = (place >= 0).all(axis=1)
        (a, b, c), (ab, bc, ca) = corners[curved].T, middles[place[curved]].T
        for three in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)):
            found.append(np.column_stack(three))
            owner.append(rows[curved])
    found.append(corners[~curved])
    owner.append(rows[~curved])
    quads = np.flatnonzero(~triangle)
    centre = len(points) + np.arange(len(quads))
    points = np.concatenate([points, points[faces[quads]].mean(axis=1)])
    for i in range(4):
        found.append(np.column_stack([faces[quads, i], faces[quads, (i + 1) % 4], centre]))
        owner.append(quads)
    return np.concatenate(found).astype(np.int64), np.concatenate(owner), points


def to_tetrahedra(points, kind, ids):
    """Tetrahedra (n,4) that make up elements, none inside out."""
    parts = EIGHT if ids.shape[1] == 10 else SPLIT[kind]
    tetra = np.concatenate([ids[:, list(part)] for part in parts])
    return right_way_round(points, "tetra", tetra)
