"""Fronts of a crack: the free edges inside the body, told from those on or outside its boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from xmpm_prep.crack_surface import Surface, drop_unused

AHEAD = 0.3  # cells ahead of an edge where the program looks for material
MARGIN = 0.5  # cells that a crack should reach beyond the boundary where it leaves the body
CUTS = 4  # looks into a cell, along each edge
SAMPLES = 200  # points along a front edge that measure how much of it lies inside
FRONT, BOUNDARY, OUTSIDE = 0, 1, 2  # classes of free edges

Inside = Callable[[np.ndarray], np.ndarray]  # which of points (n, 3) lie in the body


@dataclass(frozen=True)
class Front:
    """One front: vertices in order, the surface on their left.

    It is closed where the last one meets the first.
    """

    vertices: np.ndarray
    closed: bool
    length: float  # of the part inside the body

    @property
    def edges(self) -> np.ndarray:
        """Pairs of vertices (k, 2)."""
        following = np.roll(self.vertices, -1)
        pairs = np.column_stack([self.vertices, following])
        return pairs if self.closed else pairs[:-1]


def free_edges(surface: Surface) -> np.ndarray:
    """Free edges (k, 2) as their triangles run: the surface on the left, seen from plus."""
    return surface.edges.half[surface.edges.free()]


def ahead_of_edges(surface: Surface) -> np.ndarray:
    """Unit vectors (k, 3) in the triangles of the free edges, across them, out of the surface."""
    free = surface.edges.free()
    ends = surface.points[surface.edges.half[free]]
    ahead = np.cross(ends[:, 1] - ends[:, 0], surface.normals[free // 3])
    return ahead / np.linalg.norm(ahead, axis=1)[:, None]


def classify(surface: Surface, inside: Inside | None, h: float) -> np.ndarray:
    """FRONT, BOUNDARY or OUTSIDE for each free edge.

    A front has material 0.3 cells ahead of its middle, as the program tests it. An edge without is
    outside, or it is on the boundary if it lies less than half a cell outside.
    """
    edges = free_edges(surface)
    if inside is None or len(edges) == 0:
        return np.full(len(edges), FRONT)
    middle = surface.points[edges].mean(axis=1)
    ahead = ahead_of_edges(surface)
    kind = np.full(len(edges), OUTSIDE)
    for back in np.linspace(0.0, MARGIN, 6)[:-1]:
        kind[inside(middle - back * h * ahead)] = BOUNDARY
    kind[inside(middle + AHEAD * h * ahead)] = FRONT
    return kind


def seen_as_front(surface: Surface, inside: Inside, h: float, origin: np.ndarray) -> np.ndarray:
    """Whether the program would find material ahead of each free edge.

    It looks into the whole cell of the grid around the place 0.3 cells ahead, or with GIMP into the
    cube around the nearest node; either counts. A quarter of a cell is how finely we look.
    """
    middle = surface.points[free_edges(surface)].mean(axis=1)
    place = (middle + AHEAD * h * ahead_of_edges(surface) - origin) / h
    step = (np.arange(CUTS) + 0.5) / CUTS
    grid = np.stack(np.meshgrid(step, step, step, indexing="ij"), axis=-1).reshape(-1, 3)
    seen = np.zeros(len(place), dtype=bool)
    for shift in (0.0, 0.5):
        corner = np.floor(place - shift) + shift
        points = origin + h * (corner[:, None] + grid)
        seen |= inside(points.reshape(-1, 3)).reshape(len(place), -1).any(axis=1)
    return seen


def find_fronts(surface: Surface, kind: np.ndarray, inside: Inside | None) -> list[Front]:
    """Chains of front edges, each with its length inside the body.

    That length counts what the edges beyond an open end have inside, too.
    """
    free = free_edges(surface)
    before, after = dict(free[:, ::-1].tolist()), dict(free.tolist())
    edges = free[kind == FRONT]
    following = dict(edges.tolist())
    starts = sorted(set(following) - set(edges[:, 1].tolist()))
    chains = [(follow(following, start), False) for start in starts]
    while following:
        chain = follow(following, min(following))
        chains.append((chain[:-1], True))
    fronts = []
    for chain, closed in chains:
        front = Front(np.array(chain), closed, 0.0)
        edges = front.edges
        if not closed:
            ends = [(before[chain[0]], chain[0]), (chain[-1], after[chain[-1]])]
            edges = np.concatenate([edges, ends])
        fronts.append(Front(front.vertices, closed, inner_length(surface, edges, inside)))
    return fronts


def tails(surface: Surface, fronts: list[Front]) -> np.ndarray:
    """Whether free edges go on from the end of a front, outside, turning by less than 45 degrees.

    To take them for a part of the front does no harm.
    """
    free = free_edges(surface)
    arms = surface.points[free[:, 1]] - surface.points[free[:, 0]]
    arms /= np.linalg.norm(arms, axis=1)[:, None]
    found = np.zeros(len(free), dtype=bool)
    for end in (1, 0):
        number = dict(zip(free[:, 1 - end].tolist(), range(len(free)), strict=True))
        last = dict(zip(free[:, end].tolist(), range(len(free)), strict=True))
        for front in fronts:
            if front.closed:
                continue
            edge = last[int(front.vertices[-end])]
            following = number[int(free[edge, end])]
            while arms[following] @ arms[edge] > np.cos(np.pi / 4) and not found[following]:
                found[following] = True
                edge, following = following, number[int(free[following, end])]
    return found


def follow(following: dict[int, int], start: int) -> list[int]:
    """Vertices from a start to where a chain ends or closes; they are taken out of the table."""
    chain = [start]
    while chain[-1] in following:
        chain.append(following.pop(chain[-1]))
    return chain


def inner_length(surface: Surface, edges: np.ndarray, inside: Inside | None) -> float:
    """Length of the parts of edges that lie in the body."""
    ends = surface.points[edges]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    if inside is None:
        return float(length.sum())
    # Only where an end lies outside is there anything to cut.
    whole = inside(ends[:, 0]) & inside(ends[:, 1])
    total = length[whole].sum()
    place = (np.arange(SAMPLES) + 0.5) / SAMPLES
    for (start, end), size in zip(ends[~whole], length[~whole], strict=True):
        total += size * inside(start + place[:, None] * (end - start)).mean()
    return float(total)


def extend(surface: Surface, chosen: np.ndarray, distance: float, size: float) -> Surface:
    """Strips of a width added at chosen free edges, straight on in the planes of their triangles.

    At a corner the strips are mitred; at the end of a front they go on along the front.
    """
    free = free_edges(surface)
    edges, ahead = free[chosen], ahead_of_edges(surface)[chosen]
    step = np.zeros((len(surface.points), 3))
    count = np.zeros(len(surface.points))
    for end in range(2):
        np.add.at(step, edges[:, end], ahead)
        np.add.at(count, edges[:, end], 1)
    used = count > 0
    # Two unit vectors sum up to 2 cos(angle / 2); a mitre is 1 / cos(angle / 2) long, 2 at most.
    size_of = np.linalg.norm(step[used], axis=1)
    stretch = np.where(count[used] == 2, np.minimum(2.0 / np.maximum(size_of, 1e-3), 2.0), 1.0)
    step[used] *= (stretch / np.maximum(size_of, 1e-300))[:, None]
    go_along_front(surface, free, chosen, step)
    rows = max(1, round(distance / size))
    number = np.full(len(surface.points), -1)
    number[used] = np.arange(used.sum())
    layers = [np.flatnonzero(used)]
    points = [surface.points]
    for row in range(1, rows + 1):
        layers.append(len(surface.points) + (row - 1) * used.sum() + np.arange(used.sum()))
        points.append(surface.points[used] + step[used] * (distance * row / rows))
    points = np.concatenate(points)
    triangles = [surface.triangles]
    for low, high in pairwise(layers):
        # The edge runs from a to b with the surface on its left: the strip has it on its right.
        a, b = low[number[edges[:, 0]]], low[number[edges[:, 1]]]
        c, d = high[number[edges[:, 1]]], high[number[edges[:, 0]]]
        first = np.linalg.norm(points[a] - points[c], axis=1) <= np.linalg.norm(
            points[b] - points[d], axis=1
        )
        one = np.where(first[:, None], np.column_stack([b, a, c]), np.column_stack([b, a, d]))
        two = np.where(first[:, None], np.column_stack([c, a, d]), np.column_stack([c, b, d]))
        triangles += [one, two]
    return drop_unused(Surface(points, np.concatenate(triangles)))


def go_along_front(surface, free, chosen, step):
    """Steps at the ends of chains of chosen edges: along the other free edge that ends there."""
    leaves = {int(a): int(b) for a, b in free[~chosen]}
    comes = {int(b): int(a) for a, b in free[~chosen]}
    starts = set(free[chosen][:, 0].tolist())
    ends = set(free[chosen][:, 1].tolist())
    for vertex in starts ^ ends:
        other = comes.get(vertex) if vertex in comes else leaves.get(vertex)
        if other is None:
            continue
        along = surface.points[vertex] - surface.points[other]
        along /= np.linalg.norm(along)
        ahead = step[vertex] / np.linalg.norm(step[vertex])
        across = along @ ahead
        if across > 0.5:  # not flatter than 30 degrees to the boundary
            step[vertex] = along / across
