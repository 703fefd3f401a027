"""Particles on the grid's lattice: whole sub-cells inside a body, the cut part at its surface.

The rules are those by which the solver fills its own shapes: a cut sub-cell becomes a particle with
the volume and the centroid of its part inside; a part below 1 % joins its neighbours.
"""

import numpy as np
from scipy.spatial import cKDTree

from xmpm_prep.clip import Pieces, cut_triangles, snap
from xmpm_prep.cloud import Cloud, make_patch
from xmpm_prep.errors import PrepError
from xmpm_prep.parts import NOTHING, find, merge_slivers, pack, parts_below, takers, unpack

MOST = 200_000_000  # particles of a body: more than any memory here holds
SNAP = 1e-9  # distance from a lattice plane that is rounding, in sub-cells
DIGITS = 1e-12  # and relative to the coordinates
STL_DIGITS = 2e-7  # as single precision has them


def fill_lattice(model, body, spacing, origin):
    """The particles of a body on a lattice of sub-cells of edge `spacing` about `origin`."""
    used = np.unique(body.triangles)
    points = (model.points - origin) / spacing
    expected = body.volume / spacing**3
    if expected > MOST:
        raise PrepError(f"'{body.name}' would have {expected:.3g} particles; take a larger --h")
    digits = STL_DIGITS if model.source == "surface" else DIGITS
    tolerance = SNAP + digits * np.abs(points[used]).max()
    points = snap(points, min(tolerance, 1e-3))
    pieces = cut_triangles(points, body.triangles, f"cutting {body.name}")
    parts = parts_below(pieces)
    if len(parts.key) == 0:
        raise PrepError(f"'{body.name}' has no volume")
    merged, links = merge_slivers(parts)
    centres = unpack(merged.key) + 0.5 + merged.moment / merged.part[:, None]
    cloud = Cloud(origin + spacing * centres, spacing**3 * merged.part)
    for name, rows in body.sets.items():
        chosen = np.isin(pieces.triangle, rows)
        some = Pieces(*(getattr(pieces, item)[chosen] for item in Pieces.__dataclass_fields__))
        cloud.sets[name] = _patch(some, parts, merged, links, cloud, spacing, origin)
    return cloud


def _patch(pieces, parts, merged, links, cloud, spacing, origin):
    """Pieces of a surface given to the particles of their cells, or to who took those."""
    area = spacing**2 * pieces.area
    centre = origin + spacing * pieces.centroid
    place = find(parts.key, pack(pieces.cell))
    # Cells where rounding left nothing inside: to their neighbours, else to the nearest particle.
    lost = np.flatnonzero(place < 0)
    row, taker, share = takers(parts, pieces.cell[lost])
    piece = np.concatenate([np.flatnonzero(place >= 0), lost[row]])
    old = np.concatenate([place[place >= 0], taker])
    weight = np.concatenate([np.ones(np.count_nonzero(place >= 0)), share])
    far = np.setdiff1d(lost, lost[row])

    # From old places to particles: one row each, or one a taker of a sliver.
    order = np.argsort(links[0], kind="stable")
    start = np.searchsorted(links[0][order], old)
    count = np.searchsorted(links[0][order], old, "right") - start
    step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    link = order[np.repeat(start, count) + step]
    piece, weight = np.repeat(piece, count), np.repeat(weight, count) * links[2][link]
    particle = links[1][link]
    if len(far):
        near = cKDTree(cloud.positions).query(centre[far])[1]
        piece = np.concatenate([piece, far])
        weight = np.concatenate([weight, np.ones(len(far))])
        particle = np.concatenate([particle, near])
    big = weight > NOTHING
    return make_patch(
        cloud.positions, particle[big], area[piece[big]], centre[piece[big]], weight[big]
    )
