"""Triangulated surfaces: topology, repair and the checks that a crack must pass."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from xmpm_prep.errors import PrepError

FLAT = 1e-10  # area over squared longest edge of a degenerate triangle, as in the program


@dataclass(frozen=True)
class Surface:
    """Vertices (n, 3) and triangles (m, 3); the normals follow the right-hand rule."""

    points: np.ndarray
    triangles: np.ndarray

    @property
    def corners(self) -> np.ndarray:
        """Corners of the triangles (m, 3, 3)."""
        return self.points[self.triangles]

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """Normals of the triangles times their areas (m, 3)."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return 0.5 * np.cross(b - a, c - a)

    @cached_property
    def areas(self) -> np.ndarray:
        """Areas of the triangles (m)."""
        return np.linalg.norm(self.area_vectors, axis=1)

    @cached_property
    def normals(self) -> np.ndarray:
        """Unit normals of the triangles (m, 3)."""
        return self.area_vectors / self.areas[:, None]

    @cached_property
    def angles(self) -> np.ndarray:
        """Inner angles of the triangles at their corners (m, 3) [degrees]."""
        return np.degrees(corner_angles(self.corners))

    @property
    def extent(self) -> float:
        """Largest side of the bounding box."""
        return float(np.ptp(self.points, axis=0).max())

    @cached_property
    def edges(self) -> Edges:
        """The edges and the triangles at them."""
        return find_edges(self.triangles)

    def edge_lengths(self) -> np.ndarray:
        """Lengths of all edges, each once."""
        ends = self.points[self.edges.ends]
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


@dataclass(frozen=True)
class Edges:
    """Edges of a triangulation; a half edge is an edge as one triangle runs along it."""

    ends: np.ndarray  # (e, 2) vertices, the smaller number first
    count: np.ndarray  # (e) triangles at each edge
    of_half: np.ndarray  # (3 m) edge of each half edge; triangle t has 3 t, 3 t + 1, 3 t + 2
    half: np.ndarray  # (3 m, 2) vertices of the half edges as their triangle runs
    order: np.ndarray  # (3 m) half edges sorted by edge
    first: np.ndarray  # (e) first place of each edge in `order`

    def triangles_at(self, edge: int) -> np.ndarray:
        """Triangles at an edge."""
        start = self.first[edge]
        return self.order[start : start + self.count[edge]] // 3

    def free(self) -> np.ndarray:
        """Half edges that no second triangle shares, in the order of the triangles."""
        return np.flatnonzero(self.count[self.of_half] == 1)


def corner_angles(corners: np.ndarray) -> np.ndarray:
    """Angles of triangles (m, 3, 3) at their three corners [radians]."""
    following = np.roll(corners, -1, axis=1) - corners
    before = np.roll(corners, 1, axis=1) - corners
    cross = np.linalg.norm(np.cross(following, before), axis=2)
    return np.arctan2(cross, np.einsum("mij,mij->mi", following, before))


def find_edges(triangles: np.ndarray) -> Edges:
    """Edges of triangles (m, 3)."""
    half = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ends, of_half, count = np.unique(
        np.sort(half, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    of_half = of_half.ravel()
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    return Edges(ends, count, of_half, half, np.argsort(of_half, kind="stable"), first)


def merge_points(surface: Surface, tolerance: float) -> Surface:
    """The same triangles where vertices nearer than `tolerance` have become one."""
    pairs = cKDTree(surface.points).query_pairs(tolerance, output_type="ndarray")
    n = len(surface.points)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    count, label = connected_components(links, directed=False)
    first = np.full(count, n)
    np.minimum.at(first, label, np.arange(n))
    return drop_unused(Surface(surface.points, first[label][surface.triangles]))


def drop_unused(surface: Surface) -> Surface:
    """The same triangles without vertices that belong to none."""
    used, triangles = np.unique(surface.triangles, return_inverse=True)
    return Surface(surface.points[used], triangles.reshape(-1, 3))


def place(surface: Surface, triangle: int) -> str:
    """A triangle's number, counted from 0 as in the file, and its centre, for messages."""
    centre = ", ".join(f"{value:.6g}" for value in surface.corners[triangle].mean(axis=0))
    return f"triangle {triangle} at ({centre})"


def remove_faulty_triangles(surface: Surface) -> tuple[Surface, list[str]]:
    """Leave out degenerate triangles and repeated ones; what was done, in words.

    A degenerate triangle with two equal corners leaves no gap; one whose three different corners
    lie on a line does, and shows up later as an edge that does not fit.
    """
    notes = []
    longest = np.linalg.norm(surface.corners - np.roll(surface.corners, 1, axis=1), axis=2).max(1)
    flat = surface.areas <= FLAT * longest**2
    if flat.any():
        notes.append(f"{flat.sum()} degenerate triangles were left out")
        surface = Surface(surface.points, surface.triangles[~flat])
    _, first = np.unique(np.sort(surface.triangles, axis=1), axis=0, return_index=True)
    extra = len(surface.triangles) - len(first)
    if extra:
        notes.append(f"{extra} duplicate triangles were left out")
        surface = Surface(surface.points, surface.triangles[np.sort(first)])
    if len(surface.triangles) == 0:
        raise PrepError("the surface has no triangle with an area")
    return drop_unused(surface), notes


def check_manifold(surface: Surface) -> None:
    """At most two triangles at an edge, and one fan of them at a vertex."""
    edges = surface.edges
    branches = np.flatnonzero(edges.count > 2)
    if branches.size:
        edge = branches[0]
        middle = surface.points[edges.ends[edge]].mean(axis=0)
        raise PrepError(
            f"the surface is not manifold: {edges.count[edge]} triangles meet at the edge at "
            f"({', '.join(f'{value:.6g}' for value in middle)}), {branches.size} such edges; "
            "make the branch a crack of its own"
        )
    check_fans(surface)


def check_fans(surface: Surface) -> None:
    """All triangles at a vertex must hang together over edges at that vertex."""
    m = len(surface.triangles)
    edges = surface.edges
    shared = edges.order[edges.first[edges.count == 2][:, None] + np.array([0, 1])]
    # A corner of a triangle is a node; the two corners at each end of a shared edge are linked.
    left, right = [], []
    for end in range(2):
        vertex = edges.half[shared[:, 0], end]
        for side, half in ((left, shared[:, 0]), (right, shared[:, 1])):
            triangle = half // 3
            corner = np.argmax(surface.triangles[triangle] == vertex[:, None], axis=1)
            side.append(3 * triangle + corner)
    ones = np.ones(2 * len(shared))
    links = coo_array((ones, (np.concatenate(left), np.concatenate(right))), shape=(3 * m, 3 * m))
    _, fan = connected_components(links, directed=False)
    vertex = surface.triangles.ravel()
    fans = np.unique(np.column_stack([vertex, fan]), axis=0)
    number, count = np.unique(fans[:, 0], return_counts=True)
    if (count > 1).any():
        point = surface.points[number[count > 1][0]]
        raise PrepError(
            "the surface is not manifold: two parts touch only at the vertex "
            f"({', '.join(f'{value:.6g}' for value in point)}), {(count > 1).sum()} such vertices"
        )


def orient(surface: Surface) -> tuple[Surface, int]:
    """Turn triangles so that neighbours agree, those of the smaller area; how many were turned.

    Every triangle is two nodes of a graph, as it is (t) and turned (m + t); links join what
    agrees. A surface with two sides falls into two halves that hold each triangle once.
    """
    m = len(surface.triangles)
    edges = surface.edges
    inner = edges.first[edges.count == 2]
    first, second = edges.order[inner], edges.order[inner + 1]
    same_way = edges.half[first, 0] == edges.half[second, 0]
    first, second = first // 3, second // 3
    left = np.concatenate([first, first + m])
    right = np.concatenate([second + m * same_way, second + m * ~same_way])
    links = coo_array((np.ones(len(left)), (left, right)), shape=(2 * m, 2 * m))
    count, half = connected_components(links, directed=False)
    if (half[:m] == half[m:]).any():
        raise PrepError(
            "the surface has one side only, like a Moebius strip; a crack needs two sides"
        )
    area = np.bincount(half[:m], surface.areas, minlength=count)
    turn = area[half[:m]] < area[half[m:]]
    # Where both ways turn the same area, the first triangle of a part stays as it is.
    even = area[half[:m]] == area[half[m:]]
    turn |= even & (half[:m] > half[m:])
    triangles = surface.triangles.copy()
    triangles[turn] = triangles[turn][:, ::-1]
    return Surface(surface.points, triangles), int(turn.sum())


def parts(surface: Surface) -> int:
    """Number of separate parts."""
    edges = surface.edges
    inner = edges.first[edges.count == 2]
    pair = (edges.order[inner] // 3, edges.order[inner + 1] // 3)
    m = len(surface.triangles)
    links = coo_array((np.ones(len(inner)), pair), shape=(m, m))
    return int(connected_components(links, directed=False)[0])
