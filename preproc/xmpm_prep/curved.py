"""Curved triangles of gmsh, split into straight ones as finely as a volume needs.

gmsh meshes the surfaces coarsely and puts the nodes of elements of order 4 onto the geometry;
splitting these is a matter of polynomials, and much faster than a fine mesh. Triangles in a plane
stay whole or become a fan. Neighbours share all points of their edges, so that the surface stays
closed.
"""

from dataclasses import dataclass

import numpy as np

from xmpm_prep.errors import PrepError

ORDER = 4
FLAT = 1e-9  # distance from straight that is none, over the size of the model
NODES = 15  # of a triangle of order 4: 3 corners, 3 on each edge, 3 inside
EDGES = ((0, 1, 3), (1, 2, 6), (2, 0, 9))  # corners and the first of the nodes between


@dataclass
class Curved:
    """Triangles of order 4 on all surfaces of a model."""

    points: np.ndarray  # (n,3) nodes
    nodes: np.ndarray  # (t,15) rows of `points`
    surface: np.ndarray  # (t) tag of the surface
    tags: list  # of all surfaces
    basis: callable  # values (m,15) of the shape functions at (m,2) places

    def triangles(self, split):
        """Points and, by surface, triangles (n,3) with curved edges split into so many parts."""
        flat, straight = self._shapes()
        edges = np.concatenate([self._edge(*edge) for edge in EDGES])  # (3t,5)
        forward = edges[:, 0] < edges[:, 4]
        edges = np.where(forward[:, None], edges, edges[:, ::-1])
        _, first, number = np.unique(
            edges[:, [0, 2, 4]], axis=0, return_index=True, return_inverse=True
        )
        edges, number = edges[first], number.ravel()
        divided = np.zeros(len(edges), bool)
        divided[number[np.tile(~flat, 3) | ~straight.T.ravel()]] = True
        number = number.reshape(3, -1).T  # edge of each side of each triangle
        forward = forward.reshape(3, -1).T

        between = _edge_points(self.points[edges[divided]], split)
        place = np.full((len(edges), split - 1), -1)
        place[divided] = len(self.points) + np.arange(between.size // 3).reshape(-1, split - 1)
        points = np.concatenate([self.points, between.reshape(-1, 3)])
        side = place[number]  # (t,3,split-1)
        side = np.where(forward[:, :, None], side, side[:, :, ::-1])

        some = np.flatnonzero(~flat)
        inner = self._inner_points(some, split)
        whole, owner_of_whole, points = self._flat_ones(flat, side, divided[number], points)
        first_inner = len(points)
        points = np.concatenate([points, inner.reshape(-1, 3)])
        curved = _grids(self.nodes[some, :3], side[some], first_inner, inner.shape[1], split)
        owner = np.concatenate([owner_of_whole, np.repeat(self.surface[some], split * split)])
        return _compact(points, np.concatenate([whole, curved]), owner, self.tags)

    def _edge(self, start, end, middle):
        return self.nodes[:, [start, middle, middle + 1, middle + 2, end]]

    def _shapes(self):
        """Which triangles lie in a plane, and which of their three edges are straight."""
        tolerance = FLAT * np.ptp(self.points, axis=0).max()
        nodes = self.points[self.nodes]
        normal = np.cross(nodes[:, 1] - nodes[:, 0], nodes[:, 2] - nodes[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        height = np.einsum("tij,tj->ti", nodes - nodes[:, :1], normal)
        straight = []
        for start, end, middle in EDGES:
            part = (np.arange(3) + 1)[:, None] / 4
            line = nodes[:, start, None] + part * (nodes[:, end] - nodes[:, start])[:, None]
            off = np.linalg.norm(nodes[:, middle : middle + 3] - line, axis=2).max(axis=1)
            straight.append(off <= tolerance)
        return np.abs(height).max(axis=1) <= tolerance, np.stack(straight, axis=1)

    def _inner_points(self, some, split):
        grid = [(i, j) for j in range(1, split) for i in range(1, split - j)]
        values = self.basis(np.array(grid, float).reshape(-1, 2) / split)
        return np.einsum("mn,tnk->tmk", values, self.points[self.nodes[some]])

    def _flat_ones(self, flat, side, divided, points):
        """Flat triangles whole, or as a fan about their middle where an edge is divided."""
        plain = flat & ~divided.any(axis=1)
        found = [self.nodes[plain, :3]]
        owner = [self.surface[plain]]
        rows = np.flatnonzero(flat & divided.any(axis=1))
        centre = len(points) + np.arange(len(rows))
        points = np.concatenate([points, self.points[self.nodes[rows, :3]].mean(axis=1)])
        for i in range(3):
            ends = self.nodes[rows, i], self.nodes[rows, (i + 1) % 3]
            cut = divided[rows, i]
            found.append(np.column_stack([ends[0][~cut], ends[1][~cut], centre[~cut]]))
            owner.append(self.surface[rows[~cut]])
            chain = np.column_stack([ends[0][cut], side[rows[cut], i], ends[1][cut]])
            for a, b in zip(chain.T[:-1], chain.T[1:], strict=True):
                found.append(np.column_stack([a, b, centre[cut]]))
                owner.append(self.surface[rows[cut]])
        return np.concatenate(found), np.concatenate(owner), points


def read_curved(gmsh):
    """Raise the order of the surface mesh in gmsh and take it out."""
    gmsh.model.mesh.setOrder(ORDER)
    kind = gmsh.model.mesh.getElementType("Triangle", ORDER)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags = tags[order]
    nodes, surface = [np.zeros((0, NODES), np.int64)], [np.zeros(0, np.int64)]
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    for tag in surfaces:
        for found, _, ids in zip(*gmsh.model.mesh.getElements(2, tag), strict=True):
            if found != kind:
                raise PrepError("gmsh made quadrangles where triangles were asked for")
            ids = np.searchsorted(tags, ids.reshape(-1, NODES))
            nodes.append(ids)
            surface.append(np.full(len(ids), tag))

    def basis(places):
        local = np.column_stack([places, np.zeros(len(places))])
        _, values, _ = gmsh.model.mesh.getBasisFunctions(kind, local.ravel(), "Lagrange")
        return values.reshape(-1, NODES)

    points = coordinates.reshape(-1, 3)[order]
    return Curved(points, np.concatenate(nodes), np.concatenate(surface), surfaces, basis)


def flux_through(gmsh, surface):
    """Integral of x . n / 3 over the curved triangles of a surface: its part of a volume."""
    total = 0.0
    for kind in gmsh.model.mesh.getElementTypes(2, surface):
        local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss12")
        jacobians, _, places = gmsh.model.mesh.getJacobians(kind, local, surface)
        along = jacobians.reshape(-1, len(weights), 3, 3)  # derivatives by u, by v, normal
        normal = np.cross(along[:, :, 0], along[:, :, 1])
        places = places.reshape(-1, len(weights), 3)
        total += float(np.einsum("eqi,eqi,q->", places, normal, weights)) / 3
    return total


def _edge_points(nodes, split):
    """Points between the ends of curved edges (e,5,3), from first to last: (e,split-1,3)."""
    t = np.arange(1, split) / split
    knots = np.arange(5) / 4
    values = np.ones((len(t), 5))
    for i in range(5):
        for j in range(5):
            if i != j:
                values[:, i] *= (t - knots[j]) / (knots[i] - knots[j])
    return np.einsum("mn,enk->emk", values, nodes)


def _grids(corners, side, first_inner, n_inner, split):
    """Triangles of the grids of points in triangles that are split."""
    n = len(corners)
    grid = {(0, 0): corners[:, 0], (split, 0): corners[:, 1], (0, split): corners[:, 2]}
    for m in range(1, split):
        grid[m, 0] = side[:, 0, m - 1]
        grid[split - m, m] = side[:, 1, m - 1]
        grid[0, split - m] = side[:, 2, m - 1]
    inner = first_inner + n_inner * np.arange(n)
    count = 0
    for j in range(1, split):
        for i in range(1, split - j):
            grid[i, j] = inner + count
            count += 1
    found = []
    for j in range(split):
        for i in range(split - j):
            found.append(np.stack([grid[i, j], grid[i + 1, j], grid[i, j + 1]], axis=1))
            if i + j < split - 1:
                found.append(np.stack([grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]], axis=1))
    if not found:
        return np.zeros((0, 3), np.int64)
    return np.stack(found, axis=1).reshape(-1, 3)


def _compact(points, triangles, owner, tags):
    """Only the points in use; triangles by surface."""
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    return points[used], {tag: triangles[owner == tag] for tag in tags}
