"""Self-intersection of triangulated surfaces."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from xmpm_prep.crack_surface import Surface, place
from xmpm_prep.errors import PrepError

TOUCH = 1e-9  # of the surface's extent: nearer than this is touching
FOLD = np.cos(np.radians(1.0))  # neighbours that lie on each other to within a degree


def check_intersection(surface: Surface) -> None:
    """No triangle may cross, touch or lie on another, but for the vertices they share."""
    pairs = close_pairs(surface)
    common = count_common(surface.triangles[pairs[:, 0]], surface.triangles[pairs[:, 1]])
    tolerance = TOUCH * surface.extent
    bad = np.concatenate(
        [
            folded_pairs(surface, pairs[common == 2]),
            crossing_pairs(surface, pairs[common == 1], tolerance),
            crossing_pairs(surface, pairs[common == 0], tolerance),
        ]
    )
    if len(bad):
        first, second = bad[0]
        raise PrepError(
            f"the surface intersects or touches itself: {place(surface, first)} meets "
            f"{place(surface, second)}, {len(bad)} such pairs; write crossing cracks as "
            "cracks of their own"
        )


def close_pairs(surface: Surface) -> np.ndarray:
    """Pairs of triangles whose bounding boxes overlap (k, 2), the smaller number first."""
    centre = surface.corners.mean(axis=1)
    radius = np.linalg.norm(surface.corners - centre[:, None], axis=2).max(axis=1)
    tree = cKDTree(centre)
    slack = TOUCH * surface.extent
    found = []
    # Large triangles look for all, small ones only for small ones: few pairs either way.
    large = radius > 4.0 * np.median(radius)
    small = np.flatnonzero(~large)
    near = cKDTree(centre[small]).query_pairs(
        2.0 * radius[small].max(initial=0.0) + slack, output_type="ndarray"
    )
    found.append(small[near])
    for triangle in np.flatnonzero(large):
        others = tree.query_ball_point(
            centre[triangle], radius[triangle] + radius.max() + slack, return_sorted=True
        )
        found.append(np.column_stack([np.full(len(others), triangle), others]))
    pairs = np.concatenate(found).astype(np.intp)
    pairs = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
    low = surface.corners.min(axis=1) - slack
    high = surface.corners.max(axis=1) + slack
    overlap = (low[pairs[:, 0]] <= high[pairs[:, 1]]) & (low[pairs[:, 1]] <= high[pairs[:, 0]])
    return pairs[overlap.all(axis=1)]


def count_common(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Number of vertices that pairs of triangles (k, 3) share."""
    return (first[:, :, None] == second[:, None, :]).sum(axis=(1, 2))


def folded_pairs(surface: Surface, pairs: np.ndarray) -> np.ndarray:
    """Those neighbours over an edge that lie on each other."""
    first, second = surface.triangles[pairs[:, 0]], surface.triangles[pairs[:, 1]]
    shared = (first[:, :, None] == second[:, None, :]).any(axis=2)
    rows = np.arange(len(pairs))
    apex = first[rows, np.argmin(shared, axis=1)]
    other = second[rows, np.argmin((second[:, :, None] == first[:, None, :]).any(axis=2), axis=1)]
    start = first[rows, np.argmax(shared, axis=1)]
    end = first[rows, 2 - np.argmax(shared[:, ::-1], axis=1)]
    along = surface.points[end] - surface.points[start]
    along /= np.linalg.norm(along, axis=1)[:, None]

    def across(vertex: np.ndarray) -> np.ndarray:
        arm = surface.points[vertex] - surface.points[start]
        arm = arm - np.einsum("ij,ij->i", arm, along)[:, None] * along
        return arm / np.linalg.norm(arm, axis=1)[:, None]

    return pairs[np.einsum("ij,ij->i", across(apex), across(other)) > FOLD]


def crossing_pairs(surface: Surface, pairs: np.ndarray, tolerance: float) -> np.ndarray:
    """Those pairs where an edge of one meets the other, at no vertex that both have."""
    bad = np.zeros(len(pairs), dtype=bool)
    for one, two in ((0, 1), (1, 0)):
        mine, theirs = surface.triangles[pairs[:, one]], surface.triangles[pairs[:, two]]
        for k in range(3):
            ends = np.stack([mine[:, k], mine[:, (k + 1) % 3]], axis=1)
            # An edge that starts at a shared vertex is left to the opposite edges.
            shares = (ends[:, :, None] == theirs[:, None, :]).any(axis=(1, 2))
            look = np.flatnonzero(~shares & ~bad)
            bad[look] = segments_meet_triangles(
                surface.points[ends[look]], surface.points[theirs[look]], tolerance
            )
    return pairs[bad]


def segments_meet_triangles(
    segments: np.ndarray, triangles: np.ndarray, tolerance: float
) -> np.ndarray:
    """Whether segments (k, 2, 3) come nearer than the tolerance to triangles (k, 3, 3)."""
    if len(segments) == 0:
        return np.zeros(0, dtype=bool)
    a, b, c = np.moveaxis(triangles, 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    p, q = segments[:, 0], segments[:, 1]
    height_p = np.einsum("ij,ij->i", p - a, normal)
    height_q = np.einsum("ij,ij->i", q - a, normal)
    flat = (np.abs(height_p) <= tolerance) & (np.abs(height_q) <= tolerance)
    reaches = np.minimum(height_p, height_q) <= tolerance
    reaches &= np.maximum(height_p, height_q) >= -tolerance
    drop = np.where(np.abs(height_p - height_q) > 0, height_p - height_q, 1.0)
    point = p + np.clip(height_p / drop, 0.0, 1.0)[:, None] * (q - p)
    through = reaches & ~flat & points_in_triangles(point, a, b, c, normal, tolerance)
    lies = flat & flat_segments_meet(p, q, a, b, c, normal, tolerance)
    return through | lies


def points_in_triangles(
    point: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
    c: np.ndarray,
    normal: np.ndarray,
    tolerance: float,
) -> np.ndarray:
    """Whether points in the planes of triangles lie in them, rims included."""
    inside = np.ones(len(point), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        inward = np.cross(normal, edge)
        inward /= np.linalg.norm(inward, axis=1)[:, None]
        inside &= np.einsum("ij,ij->i", point - start, inward) >= -tolerance
    return inside


def flat_segments_meet(
    p: np.ndarray,
    q: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
    c: np.ndarray,
    normal: np.ndarray,
    tolerance: float,
) -> np.ndarray:
    """Whether segments in the planes of triangles meet them (clipping by the three sides)."""
    low, high = np.zeros(len(p)), np.ones(len(p))
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        inward = np.cross(normal, edge)
        inward /= np.linalg.norm(inward, axis=1)[:, None]
        at_p = np.einsum("ij,ij->i", p - start, inward) + tolerance
        at_q = np.einsum("ij,ij->i", q - start, inward) + tolerance
        slope = at_q - at_p
        with np.errstate(divide="ignore", invalid="ignore"):
            root = -at_p / slope
        low = np.where(slope > 0, np.maximum(low, root), low)
        high = np.where(slope < 0, np.minimum(high, root), high)
        high = np.where((slope == 0) & (at_p < 0), -1.0, high)
    return low <= high
