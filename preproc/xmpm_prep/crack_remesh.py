"""Triangulations anew with triangles of one size: split, collapse, flip, relax, project.

The steps are those of Botsch & Kobbelt, "A remeshing approach to multiresolution modeling" (2004).
The rim and sharp edges stay where they are: their vertices slide along them, their corners not at
all. All steps work on arrays; of changes that touch each other the more urgent is done and the
other waits for the next pass.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from xmpm_prep.crack_surface import Surface, corner_angles, drop_unused, find_edges

SHARP = 40.0  # neighbours that meet at more than this keep their edge; corners likewise [degrees]
LONGEST, SHORTEST = 4.0 / 3.0, 0.8  # edges outside are split or collapsed [wanted size]
PASSES = 12  # of all steps, at most
SETTLED = 0.01  # of the triangles come or go: enough passes
LEAST = 0.05  # smallest angle that a collapse may make [radians]
FIXED, LINE, FREE = 2, 1, 0  # how a vertex may move: not at all, along its line, in the surface


def remesh(surface: Surface, size: float) -> Surface:
    """The surface with edges of about a size."""
    lines = feature_lines(surface)
    original = Original(surface, lines, size)
    points, triangles = surface.points.copy(), surface.triangles.copy()
    kind = vertex_kinds(surface, lines)
    for number in range(PASSES):
        count = len(triangles)
        points, triangles, lines, kind = split_long(points, triangles, lines, kind, LONGEST * size)
        changed = len(triangles) - count
        points, triangles, lines, kind = collapse_short(
            points, triangles, lines, kind, SHORTEST * size, LONGEST * size
        )
        changed += abs(len(triangles) - count - changed)
        triangles = flip_all(points, triangles, lines)
        for _ in range(3):
            points = relax(points, triangles, lines, kind, original)
        if number > 2 and changed < SETTLED * len(triangles):
            break
    for _ in range(5):
        triangles = flip_all(points, triangles, lines)
        points = relax(points, triangles, lines, kind, original)
    triangles, _ = flip(points, triangles, lines)
    return drop_unused(Surface(points, triangles))


# --- lines that stay ----------------------------------------------------------------------------


def feature_lines(surface: Surface) -> np.ndarray:
    """Edges of the rim and sharp edges (k, 2)."""
    edges = surface.edges
    sharp = np.zeros(len(edges.ends), dtype=bool)
    inner = np.flatnonzero(edges.count == 2)
    first, second = edges.order[edges.first[inner]] // 3, edges.order[edges.first[inner] + 1] // 3
    cosine = np.einsum("ij,ij->i", surface.normals[first], surface.normals[second])
    sharp[inner] = cosine < np.cos(np.radians(SHARP))
    return edges.ends[sharp | (edges.count == 1)]


def vertex_kinds(surface: Surface, lines: np.ndarray) -> np.ndarray:
    """FREE off the lines, LINE on a smooth one, FIXED at their ends, corners and branches."""
    n = len(surface.points)
    degree = np.bincount(lines.ravel(), minlength=n)
    kind = np.where(degree == 0, FREE, np.where(degree == 2, LINE, FIXED))
    arm = surface.points[lines[:, 1]] - surface.points[lines[:, 0]]
    arm /= np.linalg.norm(arm, axis=1)[:, None]
    total = np.zeros((n, 3))
    np.add.at(total, lines[:, 0], arm)
    np.subtract.at(total, lines[:, 1], arm)
    # Two unit vectors away from a vertex sum up to 2 sin(turn / 2).
    turns = np.linalg.norm(total, axis=1) > 2.0 * np.sin(np.radians(SHARP) / 2.0)
    kind[(kind == LINE) & turns] = FIXED
    return kind


class Original:
    """The surface as it was: where vertices are put back after each move."""

    def __init__(self, surface: Surface, lines: np.ndarray, size: float):
        self.corners = surface.corners
        self.ends = surface.points[lines]
        # Points that stand for triangles and lines, dense enough to find the nearest ones by.
        self.reach = min(size, float(np.median(surface.edge_lengths())))
        self.samples, self.owner = sample_triangles(self.corners, self.reach)
        self.tree = cKDTree(self.samples)
        self.line_samples, self.line_owner = sample_segments(self.ends, self.reach)
        self.line_tree = cKDTree(self.line_samples) if len(lines) else None

    def project(self, points: np.ndarray) -> np.ndarray:
        """Nearest points of the surface, among the triangles of the nearest samples."""
        near = self.tree.query(points, k=min(12, len(self.samples)))[1].reshape(len(points), -1)
        return nearest_of(points, self.owner[near], self.corners, nearest_on_triangles)

    def project_to_lines(self, points: np.ndarray) -> np.ndarray:
        """Nearest points of the lines."""
        count = min(6, len(self.line_samples))
        near = self.line_tree.query(points, k=count)[1].reshape(len(points), -1)
        return nearest_of(points, self.line_owner[near], self.ends, nearest_on_segments)


def nearest_of(points, candidates, shapes, nearest):
    """Of some candidates for each point the nearest point on any."""
    rows = np.repeat(np.arange(len(points)), candidates.shape[1])
    found = nearest(points[rows], shapes[candidates.ravel()])
    distance = np.linalg.norm(found - points[rows], axis=1).reshape(candidates.shape)
    best = np.argmin(distance, axis=1)
    return found.reshape(*candidates.shape, 3)[np.arange(len(points)), best]


def sample_triangles(corners: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points in triangles not much further apart than a spacing, and whose they are."""
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(longest / spacing), 1, 60).astype(int)
    samples, owner = [], []
    for n in np.unique(parts):
        mine = np.flatnonzero(parts == n)
        i, j = np.triu_indices(n + 1)
        weights = np.column_stack([i, j - i, n - j]) / n
        weights = 0.98 * weights + 0.02 / 3.0  # a little inside, so that each has its owner
        samples.append(np.einsum("wk,mkj->mwj", weights, corners[mine]).reshape(-1, 3))
        owner.append(np.repeat(mine, len(weights)))
    return np.concatenate(samples), np.concatenate(owner)


def sample_segments(ends: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points on segments not further apart than a spacing, and whose they are."""
    if len(ends) == 0:
        return np.zeros((0, 3)), np.zeros(0, dtype=int)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    parts = np.maximum(1, np.ceil(length / spacing)).astype(int)
    owner = np.repeat(np.arange(len(ends)), parts)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    place = (step + 0.5) / parts[owner]
    return ends[owner, 0] + place[:, None] * (ends[owner, 1] - ends[owner, 0]), owner


def nearest_on_segments(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Nearest points on segments (k, 2, 3)."""
    arm = ends[:, 1] - ends[:, 0]
    place = np.einsum("ij,ij->i", points - ends[:, 0], arm) / np.einsum("ij,ij->i", arm, arm)
    return ends[:, 0] + np.clip(place, 0.0, 1.0)[:, None] * arm


def nearest_on_triangles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Nearest points on triangles (k, 3, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    best = points - np.einsum("ij,ij->i", points - a, normal)[:, None] * normal
    inside = np.ones(len(points), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inward = np.cross(normal, end - start)
        inside &= np.einsum("ij,ij->i", best - start, inward) >= 0.0
    distance = np.where(inside, 0.0, np.inf)
    outside = np.flatnonzero(~inside)
    for k in range(3):
        found = nearest_on_segments(points[outside], corners[outside][:, [k, (k + 1) % 3]])
        gap = np.linalg.norm(found - points[outside], axis=1)
        closer = gap < distance[outside]
        best[outside[closer]] = found[closer]
        distance[outside[closer]] = gap[closer]
    return best


# --- steps ----------------------------------------------------------------------------------------


def split_long(points, triangles, lines, kind, longest):
    """Halve edges that are too long, until none is."""
    for _ in range(40):
        edges = find_edges(triangles)
        arm = points[edges.ends[:, 1]] - points[edges.ends[:, 0]]
        marked = np.linalg.norm(arm, axis=1) > longest
        if not marked.any():
            break
        middle = np.full(len(edges.ends), -1)
        middle[marked] = len(points) + np.arange(marked.sum())
        points = np.concatenate([points, points[edges.ends[marked]].mean(axis=1)])
        on_line = find_rows(edges.ends, lines)
        is_line = np.zeros(len(edges.ends), dtype=bool)
        is_line[on_line] = True
        kind = np.concatenate([kind, np.where(is_line[marked], LINE, FREE)])
        cut = marked[on_line]
        new = middle[on_line[cut]]
        lines = np.concatenate(
            [
                lines[~cut],
                np.column_stack([lines[cut, 0], new]),
                np.column_stack([new, lines[cut, 1]]),
            ]
        )
        triangles = split_triangles(points, triangles, middle[edges.of_half].reshape(-1, 3))
    return points, triangles, np.sort(lines, axis=1), kind


def split_triangles(points, triangles, middle):
    """Triangles cut at the middles (m, 3) of their edges, -1 for edges that stay."""
    count = (middle >= 0).sum(axis=1)
    made = [triangles[count == 0]]
    # Turned so that the first edge is cut (one cut), or the last is not (two cuts).
    for number, shift in ((1, np.argmax(middle >= 0, axis=1)), (2, np.argmin(middle, axis=1) + 1)):
        rows = np.flatnonzero(count == number)
        turn = (shift[rows, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles[rows], turn, axis=1).T
        p, q, _ = np.take_along_axis(middle[rows], turn, axis=1).T
        if number == 1:
            made += [np.column_stack([a, p, c]), np.column_stack([p, b, c])]
            continue
        made.append(np.column_stack([p, b, q]))
        # The rest has four corners a, p, q, c: cut along its shorter diagonal.
        short = np.linalg.norm(points[a] - points[q], axis=1) <= np.linalg.norm(
            points[p] - points[c], axis=1
        )
        made.append(
            np.where(short[:, None], np.column_stack([a, p, q]), np.column_stack([a, p, c]))
        )
        made.append(
            np.where(short[:, None], np.column_stack([a, q, c]), np.column_stack([p, q, c]))
        )
    whole = count == 3
    a, b, c = triangles[whole].T
    p, q, r = middle[whole].T
    for some in ((a, p, r), (p, b, q), (r, q, c), (p, q, r)):
        made.append(np.column_stack(some))
    return np.concatenate(made)


def find_rows(table: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Places of rows (k, 2) in a table (n, 2) that is sorted and has them all."""
    width = int(table.max(initial=0)) + 1
    rows = np.sort(rows, axis=1)
    return np.searchsorted(table[:, 0] * width + table[:, 1], rows[:, 0] * width + rows[:, 1])


def collapse_short(points, triangles, lines, kind, shortest, longest):
    """Make one vertex of the ends of short edges, of those near each other the shortest first."""
    points = points.copy()
    for _ in range(60):
        edges = find_edges(triangles)
        length = np.linalg.norm(points[edges.ends[:, 1]] - points[edges.ends[:, 0]], axis=1)
        is_line = np.zeros(len(edges.ends), dtype=bool)
        is_line[find_rows(edges.ends, lines)] = True
        short = np.flatnonzero(length < shortest)
        short, gone, kept, place = choose_collapses(edges.ends, short, is_line, points, kind)
        good = may_collapse(gone, kept, place, points, triangles, edges, short, longest)
        short, gone, kept, place = short[good], gone[good], kept[good], place[good]
        chosen = apart(edges.ends, short, length, len(points))
        if not chosen.any():
            break
        target = np.arange(len(points))
        target[gone[chosen]] = kept[chosen]
        points[kept[chosen]] = place[chosen]
        triangles = target[triangles]
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (c != a)]
        lines = np.sort(target[lines], axis=1)
        lines = np.unique(lines[lines[:, 0] != lines[:, 1]], axis=0)
    return points, triangles, lines, kind


def choose_collapses(ends, short, is_line, points, kind):
    """Which end of short edges vanishes into which, and where that goes.

    The end that moves more freely vanishes; edges that may not are left out.
    """
    swap = kind[ends[short, 0]] > kind[ends[short, 1]]
    gone = np.where(swap, ends[short, 1], ends[short, 0])
    kept = np.where(swap, ends[short, 0], ends[short, 1])
    may = (kind[gone] == FREE) | ((kind[gone] == LINE) & is_line[short])
    short, gone, kept = short[may], gone[may], kept[may]
    place = points[kept].copy()
    free = (kind[gone] == FREE) & (kind[kept] == FREE)
    place[free] = 0.5 * (points[gone[free]] + points[kept[free]])
    return short, gone, kept, place


def around(table_first, table, vertices):
    """Rows of a table that belong to vertices: which vertex of the list, and the row."""
    count = table_first[vertices + 1] - table_first[vertices]
    number = np.repeat(np.arange(len(vertices)), count)
    step = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
    return number, table[table_first[vertices][number] + step]


def may_collapse(gone, kept, place, points, triangles, edges, short, longest):
    """Whether the surface stays a surface, turns nowhere and gets no edge that is too long."""
    n, m = len(points), len(short)
    if m == 0:
        return np.zeros(0, dtype=bool)
    # Neighbours that both ends have: one a triangle, else parts would be pinched together.
    both = np.concatenate([edges.ends, edges.ends[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], np.arange(n + 1))
    rows = [around(first, both[:, 1], vertices) for vertices in (gone, kept)]
    keys = np.concatenate([number * n + vertex for number, vertex in rows])
    key, count = np.unique(keys, return_counts=True)
    common = np.bincount(key[count == 2] // n, minlength=m)
    good = common == edges.count[short]
    # Triangles around the ends but for those that vanish.
    flat = triangles.ravel()
    order = np.argsort(flat, kind="stable")
    first = np.searchsorted(flat[order], np.arange(n + 1))
    rows = [around(first, order // 3, vertices) for vertices in (gone, kept)]
    number = np.concatenate([row[0] for row in rows])
    corners = triangles[np.concatenate([row[1] for row in rows])]
    is_end = (corners == gone[number, None]) | (corners == kept[number, None])
    stays = is_end.sum(axis=1) == 1
    number, corners, is_end = number[stays], corners[stays], is_end[stays]
    before = points[corners]
    after = np.where(is_end[:, :, None], place[number][:, None], before)
    old = np.cross(before[:, 1] - before[:, 0], before[:, 2] - before[:, 0])
    new = np.cross(after[:, 1] - after[:, 0], after[:, 2] - after[:, 0])
    size = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    bad = np.einsum("ij,ij->i", old, new) <= 0.5 * size
    bad |= (np.linalg.norm(after - np.roll(after, 1, axis=1), axis=2) > longest).any(axis=1)
    bad |= corner_angles(after).min(axis=1) < LEAST
    return (
        good & (np.bincount(number[bad], minlength=m) == 0) & (np.bincount(number, minlength=m) > 0)
    )


def apart(ends, short, length, n):
    """Of short edges as many as have no other up to two edges around, the shortest first."""
    chosen = np.zeros(len(short), dtype=bool)
    rank = np.empty(len(short))
    rank[np.argsort(length[short], kind="stable")] = np.arange(len(short))
    free = np.ones(len(short), dtype=bool)
    while free.any():
        least = np.full(n, np.inf)
        for end in range(2):
            np.minimum.at(least, ends[short[free], end], rank[free])
        least = spread_least(ends, spread_least(ends, least))
        first, second = least[ends[short]].T
        best = free & (rank == first) & (rank == second)
        chosen |= best
        near = np.ones(n)
        near[ends[short[best]].ravel()] = 0.0
        near = spread_least(ends, spread_least(ends, near))
        free &= (near[ends[short]] > 0.0).all(axis=1)
    return chosen


def spread_least(ends, values):
    """The least value at each vertex and those that an edge joins to it."""
    spread = values.copy()
    np.minimum.at(spread, ends[:, 0], values[ends[:, 1]])
    np.minimum.at(spread, ends[:, 1], values[ends[:, 0]])
    return spread


def flip_all(points, triangles, lines):
    """Turn edges until hardly any can be."""
    for _ in range(4):
        triangles, changed = flip(points, triangles, lines)
        if not changed:
            break
    return triangles


def flip(points, triangles, lines):
    """Turn edges where that makes the smallest angle of their two triangles larger."""
    edges = find_edges(triangles)
    is_line = np.zeros(len(edges.ends), dtype=bool)
    is_line[find_rows(edges.ends, lines)] = True
    inner = np.flatnonzero((edges.count == 2) & ~is_line)
    half = edges.order[edges.first[inner][:, None] + np.array([0, 1])]
    first, second = half.T // 3
    a, b = edges.half[half[:, 0]].T
    c = triangles[first, (half[:, 0] + 2) % 3]
    d = triangles[second, (half[:, 1] + 2) % 3]
    old = np.minimum(
        corner_angles(points[triangles[first]]).min(axis=1),
        corner_angles(points[triangles[second]]).min(axis=1),
    )
    one, two = np.column_stack([a, d, c]), np.column_stack([d, b, c])
    new = np.minimum(corner_angles(points[one]).min(axis=1), corner_angles(points[two]).min(axis=1))
    normal = Surface(points, triangles).area_vectors
    normal = normal[first] + normal[second]
    for some in (one, two):
        upright = np.einsum("ij,ij->i", Surface(points, some).area_vectors, normal)
        new[upright <= 0.0] = -1.0
    new[has_rows(edges.ends, np.column_stack([c, d]))] = -1.0
    gain = np.where(new > old + 1e-6, new - old, 0.0)
    # The best edge of both its triangles; none where two edges would end as the same one.
    best = np.zeros(len(triangles))
    np.maximum.at(best, first, gain)
    np.maximum.at(best, second, gain)
    chosen = np.flatnonzero((gain > 0.0) & (gain >= best[first]) & (gain >= best[second]))
    _, once = np.unique(np.sort(np.column_stack([c, d])[chosen], axis=1), axis=0, return_index=True)
    chosen = chosen[np.sort(once)]
    used = np.zeros(len(triangles), dtype=int)
    np.add.at(used, first[chosen], 1)
    np.add.at(used, second[chosen], 1)
    chosen = chosen[(used[first[chosen]] == 1) & (used[second[chosen]] == 1)]
    result = triangles.copy()
    result[first[chosen]] = one[chosen]
    result[second[chosen]] = two[chosen]
    return result, len(chosen)


def has_rows(table: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whether rows (k, 2) are in a table (n, 2)."""
    width = int(max(table.max(initial=0), rows.max(initial=0))) + 1
    rows = np.sort(rows, axis=1)
    return np.isin(rows[:, 0] * width + rows[:, 1], table[:, 0] * width + table[:, 1])


def relax(points, triangles, lines, kind, original):
    """Move vertices towards the middle of those around them, on the surface and on its lines."""
    n = len(points)
    area = Surface(points, triangles).areas
    total, weight = np.zeros((n, 3)), np.zeros(n)
    centre = points[triangles].mean(axis=1) * area[:, None]
    for k in range(3):
        np.add.at(total, triangles[:, k], centre)
        np.add.at(weight, triangles[:, k], area)
    moved = points.copy()
    free = np.flatnonzero((kind == FREE) & (weight > 0))
    if free.size:
        moved[free] = original.project(total[free] / weight[free][:, None])
    slides = np.flatnonzero((kind == LINE) & (weight > 0))
    if slides.size:
        total, count = np.zeros((n, 3)), np.zeros(n)
        for one, two in ((0, 1), (1, 0)):
            np.add.at(total, lines[:, one], points[lines[:, two]])
            np.add.at(count, lines[:, one], 1.0)
        slides = slides[count[slides] > 0]
        moved[slides] = original.project_to_lines(total[slides] / count[slides][:, None])
    return keep_upright(points, moved, triangles)


def keep_upright(points, moved, triangles):
    """Take moves back whose triangles would turn over or all but vanish."""
    old = Surface(points, triangles).area_vectors
    for _ in range(10):
        new = Surface(moved, triangles).area_vectors
        size = np.linalg.norm(old, axis=1)
        bad = np.einsum("ij,ij->i", old, new) < 0.1 * size * size
        bad &= np.linalg.norm(moved[triangles] - points[triangles], axis=2).max(axis=1) > 0
        if not bad.any():
            return moved
        back = np.unique(triangles[bad])
        moved[back] = points[back]
    return points
