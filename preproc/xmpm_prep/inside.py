"""Which points lie in a solid: parity of crossings of a line in z, exact whatever it hits.

A line through an edge or a vertex of the surface is taken as if it were moved by an infinitesimal
in x and a smaller one in y, so that every crossing counts once. Signs are those of the exact
determinant: where floating point cannot tell, rational numbers decide. Points on the surface count
as inside.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np

from xmpm_prep.progress import progress

BATCH = 4_000_000  # pairs of a line and a triangle that are looked at together
ROUNDING = 8 * np.finfo(float).eps


def is_inside(queries, points, triangles):
    """Whether each of (n,3) points lies in the solid of a closed surface, or on it."""
    queries = np.asarray(queries, float)
    result = np.zeros(len(queries), bool)
    if len(triangles) == 0 or len(queries) == 0:
        return result
    corners = np.asarray(points, float)[triangles]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    near = np.flatnonzero(np.all((queries >= low) & (queries <= high), axis=1))
    if len(near) == 0:
        return result
    lines, line_of = np.unique(queries[near, :2], axis=0, return_inverse=True)
    line, triangle = _candidates(lines, corners)
    crossed, on_edge = _crossed(lines, corners, line, triangle)
    result[near] = _parity(
        queries[near], line_of.ravel(), corners, (line, triangle, crossed, on_edge), len(lines)
    )
    return result


def _candidates(lines, corners):
    """Pairs of a line and a triangle whose bounds in x and y it meets."""
    low, high = corners[:, :, :2].min(axis=1), corners[:, :, :2].max(axis=1)
    order = np.lexsort((lines[:, 1], lines[:, 0]))
    # Strips in x, in each of them lines sorted by y.
    strips = max(1, int(np.sqrt(len(lines))))
    strip = np.minimum(np.arange(len(lines)) * strips // len(lines), strips - 1)
    order = order[np.lexsort((lines[order, 1], strip))]
    first = np.searchsorted(strip, np.arange(strips + 1))
    x = lines[order, 0]
    strip_low = np.array([x[a:b].min() for a, b in pairwise(first)])
    strip_high = np.array([x[a:b].max() for a, b in pairwise(first)])
    found = []
    for number in range(strips):
        y = lines[order[first[number] : first[number + 1]], 1]
        some = np.flatnonzero((low[:, 0] <= strip_high[number]) & (high[:, 0] >= strip_low[number]))
        start = np.searchsorted(y, low[some, 1], "left")
        count = np.searchsorted(y, high[some, 1], "right") - start
        triangle = np.repeat(some, count)
        place = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count - start, count)
        line = order[first[number] + place]
        x = lines[line, 0]
        hit = (x >= low[triangle, 0]) & (x <= high[triangle, 0])
        found.append((line[hit], triangle[hit]))
    return tuple(np.concatenate(part) for part in zip(*found, strict=True))


def _crossed(lines, corners, line, triangle):
    """Whether moved lines cross triangles, and whether the unmoved meet them at all."""
    crossed = np.zeros(len(line), bool)
    touched = np.zeros(len(line), bool)
    for start in range(0, len(line), BATCH):
        part = slice(start, start + BATCH)
        q, c = lines[line[part]], corners[triangle[part], :, :2]
        sides = [_side(c[:, i], c[:, (i + 1) % 3], q) for i in range(3)]
        moved = np.stack([side[1] for side in sides])
        exact = np.stack([side[0] for side in sides])
        crossed[part] = (moved > 0).all(axis=0) | (moved < 0).all(axis=0)
        touched[part] = (exact >= 0).all(axis=0) | (exact <= 0).all(axis=0)
    return crossed, touched


def _side(a, b, q):
    """Sign of the determinant |b - a, q - a|, and that for a point moved by a little."""
    ux, uy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1]
    vx, vy = q[:, 0] - a[:, 0], q[:, 1] - a[:, 1]
    left, right = ux * vy, uy * vx
    value = left - right
    sign = np.sign(value).astype(np.int8)
    # One product alone has the right sign; a difference of two may not.
    doubtful = (ux != 0) & (uy != 0) & (np.abs(value) <= ROUNDING * (np.abs(left) + np.abs(right)))
    for i in np.flatnonzero(doubtful):
        sign[i] = _exact_side(a[i], b[i], q[i])
    # Moved by e in x and e**2 in y the determinant changes by -uy e + ux e**2.
    up, along = _compare(a[:, 1], b[:, 1]), _compare(b[:, 0], a[:, 0])
    moved = np.where(sign != 0, sign, np.where(up != 0, up, along))
    return sign, moved


def _compare(a, b):
    return (a > b).astype(np.int8) - (a < b).astype(np.int8)


def _exact_side(a, b, q):
    if (a[0] == q[0] and a[1] == q[1]) or (b[0] == q[0] and b[1] == q[1]):
        return 0
    if (a[0] == b[0] == q[0]) or (a[1] == b[1] == q[1]):
        return 0
    ax, ay, bx, by, qx, qy = (Fraction(float(v)) for v in (*a, *b, *q))
    value = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
    return (value > 0) - (value < 0)


def _parity(queries, line_of, corners, pairs, n_lines):
    """Whether an odd number of triangles is crossed above each point, or one touched at it."""
    line, triangle, crossed, touched = pairs
    used = crossed | touched
    line, triangle, crossed, touched = (part[used] for part in (line, triangle, crossed, touched))
    order = np.argsort(line, kind="stable")
    line, triangle, crossed, touched = (part[order] for part in (line, triangle, crossed, touched))
    first = np.searchsorted(line, np.arange(n_lines + 1))
    count = (first[1:] - first[:-1])[line_of]
    odd = np.zeros(len(queries), bool)
    on_surface = np.zeros(len(queries), bool)
    facing = _side(corners[:, 0, :2], corners[:, 1, :2], corners[:, 2, :2])[0]
    # Points in batches; each against all triangles of its line.
    ends = np.cumsum(count)
    batches = np.searchsorted(ends, np.arange(0, ends[-1] if len(ends) else 0, BATCH), "left")
    limits = [*np.unique(batches).tolist(), len(queries)]
    for a, b in progress(list(pairwise(limits)), "points in the solid"):
        point = np.repeat(np.arange(a, b), count[a:b])
        step = np.arange(len(point)) - np.repeat(np.cumsum(count[a:b]) - count[a:b], count[a:b])
        pair = first[line_of[point]] + step
        upright = facing[triangle[pair]] == 0
        sides = _in_upright(queries[point[upright]], corners[triangle[pair[upright]]])
        on_surface[point[upright][sides]] = True
        point, pair = point[~upright], pair[~upright]
        height = _heights(queries[point], corners[triangle[pair]]) * facing[triangle[pair]]
        odd ^= np.bincount(point[crossed[pair] & (height > 0)], minlength=len(odd)) % 2 == 1
        on_surface[point[touched[pair] & (height == 0)]] = True
    return odd | on_surface


def _heights(q, c):
    """Sign of how far planes of triangles lie above points, times where the triangles face."""
    u, v, w = c[:, 1] - c[:, 0], c[:, 2] - c[:, 0], q - c[:, 0]
    normal = np.empty_like(u)
    bound = np.zeros(len(u))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        left, right = u[:, j] * v[:, k], u[:, k] * v[:, j]
        normal[:, i] = left - right
        bound += (np.abs(left) + np.abs(right)) * np.abs(w[:, i])
    value = np.einsum("ij,ij->i", normal, w)
    sign = -np.sign(value).astype(np.int8)
    doubtful = np.abs(value) <= 2 * ROUNDING * bound
    # All corners and the point in one lattice plane: no need to compute.
    for axis in range(3):
        doubtful &= (u[:, axis] != 0) | (v[:, axis] != 0) | (w[:, axis] != 0)
    for i in np.flatnonzero(doubtful):
        sign[i] = -_exact_height(q[i], c[i])
    return sign


def _exact_height(q, c):
    a, b, d, p = ([Fraction(float(v)) for v in row] for row in (*c, q))
    u, v, w = ([x - y for x, y in zip(row, a, strict=True)] for row in (b, d, p))
    value = (
        (u[1] * v[2] - u[2] * v[1]) * w[0]
        + (u[2] * v[0] - u[0] * v[2]) * w[1]
        + (u[0] * v[1] - u[1] * v[0]) * w[2]
    )
    return (value > 0) - (value < 0)


def _in_upright(q, c):
    """Whether points lie in triangles that contain the direction z."""
    bounded = np.all((q >= c.min(axis=1)) & (q <= c.max(axis=1)), axis=1)
    result = np.zeros(len(q), bool)
    chosen = np.flatnonzero(bounded)
    chosen = chosen[_heights(q[chosen], c[chosen]) == 0]
    wide = np.ptp(c[chosen, :, 0], axis=1) >= np.ptp(c[chosen, :, 1], axis=1)
    for axis, some in ((0, chosen[wide]), (1, chosen[~wide])):
        t, p = c[some][:, :, [axis, 2]], q[some][:, [axis, 2]]
        sides = np.stack([_side(t[:, i], t[:, (i + 1) % 3], p)[0] for i in range(3)])
        result[some] = (sides >= 0).all(axis=0) | (sides <= 0).all(axis=0)
    return result
