"""Volume and centroid of a solid in each cell of a lattice, from its closed surface.

The part of a cell that lies below the surface is a sum over the pieces of the surface in the cell
and above it in its column (divergence theorem for the field (0, 0, z)). It is exact for the
triangulation and needs no test of which side a point is on; pieces parallel to the column add
nothing, so that no case is special.
"""

from dataclasses import dataclass

import numpy as np

from xmpm_prep.errors import PrepError

LEAST = 0.01 * (1 - 1e-6)  # smallest part of a cell that stands alone, as in the solver
NOTHING = 1e-9  # what rounding leaves of nothing, and takes from a whole cell
WRONG = 1e-6  # a part beyond 0 or 1 by more is no rounding
OFFSET = 2**20  # makes packed cells positive
NEIGHBOURS = np.array(
    [(i, j, k) for k in (-1, 0, 1) for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j or k]
)
CLASSES = np.abs(NEIGHBOURS).sum(axis=1)  # 1 over a face, 2 an edge, 3 a corner


@dataclass
class Parts:
    """What a solid has of each cell, in units of cells, sorted by z, then y, then x."""

    key: np.ndarray  # (n) packed cells, ascending
    part: np.ndarray  # (n) volume, 0 to 1
    moment: np.ndarray  # (n,3) of the volume about the cell's centre


def pack(cell):
    """One number for a cell, ordered by z, then y, then x."""
    i, j, k = (cell + OFFSET).astype(np.int64).T
    return i | j << 21 | k << 42


def unpack(key):
    """Cells (n,3) of packed numbers."""
    return np.column_stack([key & (2**21 - 1), key >> 21 & (2**21 - 1), key >> 42]) - OFFSET


def parts_below(pieces):
    """Parts of all cells that a solid reaches into, from the pieces of its surface."""
    if np.abs(pieces.cell).max(initial=0) >= OFFSET - 2:
        raise PrepError(f"the model reaches over more than {OFFSET - 2} particles from the origin")
    # Sum the pieces of each cell; columns together, the highest cell first.
    order = np.lexsort((-pieces.cell[:, 2], pieces.cell[:, 0], pieces.cell[:, 1]))
    cell = pieces.cell[order]
    starts = np.flatnonzero(np.any(np.diff(cell, axis=0, prepend=cell[:1] - 1) != 0, axis=1))
    flux = np.add.reduceat(pieces.flux[order], starts, axis=0)
    cell = cell[starts]
    above, same = _sum_above(cell, flux[:, :3])

    # Cells with pieces: what lies under higher pieces fills them, and their own.
    full, x, y = above.T
    part = full + flux[:, 3]
    moment = np.column_stack([x + flux[:, 4], y + flux[:, 5], full / 2 + flux[:, 6]])

    # Cells between them in a column hold what the pieces above leave.
    gap = np.zeros(len(cell), np.int64)
    gap[:-1] = np.where(same, cell[:-1, 2] - cell[1:, 2] - 1, 0)
    below = above + flux[:, :3]
    gap[np.abs(below[:, 0]) < NOTHING] = 0
    upper = np.repeat(np.arange(len(cell)), gap)
    deeper = np.arange(len(upper)) - np.repeat(np.cumsum(gap) - gap, gap) + 1
    between = cell[upper]
    between[:, 2] -= deeper
    filled = below[upper]
    return _tidy(
        np.concatenate([cell, between]),
        np.concatenate([part, filled[:, 0]]),
        np.concatenate([moment, np.column_stack([filled[:, 1:], filled[:, 0] / 2])]),
    )


def _sum_above(cell, flux):
    """Sums over higher cells of each column; whether the next entry is of the same column."""
    same = np.all(cell[1:, :2] == cell[:-1, :2], axis=1)
    first = np.flatnonzero(np.concatenate([[True], ~same]))
    # Within columns, so that nothing of other columns is rounded in: by depth in the column.
    length = np.diff([*first, len(cell)])
    above = np.zeros_like(flux)
    for depth in range(1, length.max(initial=1)):
        here = first[length > depth] + depth
        above[here] = above[here - 1] + flux[here - 1]
    return above, same


def _tidy(cell, part, moment):
    """Rounding taken out, moments about the centres, sorted."""
    beyond = np.abs(part - np.clip(part, 0, 1))
    if np.max(beyond, initial=0) > WRONG:
        worst = np.argmax(beyond)
        raise PrepError(
            f"the surface crosses or overlaps itself: it encloses {part[worst]:.3g} times the "
            f"lattice cell {tuple(cell[worst].tolist())} of a particle"
        )
    moment = moment - part[:, None] / 2
    whole = part > 1 - NOTHING
    part = np.where(whole, 1.0, part)
    moment[whole] = 0.0
    there = part > NOTHING
    key = pack(cell[there])
    order = np.argsort(key, kind="stable")
    return Parts(key[order], part[there][order], moment[there][order])


def find(keys, wanted):
    """Places of keys in an ascending list, -1 where they are missing."""
    place = np.searchsorted(keys, wanted)
    place[place == len(keys)] = 0
    return np.where(keys[place] == wanted, place, -1) if len(keys) else place - 1


def takers(parts, cell):
    """Who takes what is too small to stand alone, as the solver does it.

    The nearest class of neighbours (over a face, an edge, a corner) of which any stands alone, each
    in proportion to its part. Three arrays: number of the cell given, place of the taker, share.
    """
    place = np.stack([find(parts.key, pack(cell + step)) for step in NEIGHBOURS], axis=1)
    weight = np.where(place >= 0, parts.part[place], 0.0)
    weight[weight < LEAST] = 0.0
    for_class = np.stack([weight[:, kind == CLASSES].sum(axis=1) for kind in (1, 2, 3)], axis=1)
    some = for_class > 0
    nearest = np.where(some.any(axis=1), 1 + np.argmax(some, axis=1), 0)
    weight[nearest[:, None] != CLASSES] = 0.0
    row, column = np.nonzero(weight)
    total = np.take_along_axis(for_class, np.maximum(nearest - 1, 0)[:, None], axis=1)[row, 0]
    return row, place[row, column], weight[row, column] / total


def merge_slivers(parts):
    """Parts below 1 % joined to their neighbours, volume and moment: nothing is lost.

    Returns the new parts and, for each old one, rows of (old place, new place, share).
    """
    small = np.flatnonzero(parts.part < LEAST)
    row, taker, share = takers(parts, unpack(parts.key[small]))
    gone = np.zeros(len(parts.key), bool)
    gone[small[row]] = True
    part, moment = parts.part.copy(), parts.moment.copy()
    sliver = small[row]
    apart = unpack(parts.key[sliver]) - unpack(parts.key[taker])
    np.add.at(part, taker, share * parts.part[sliver])
    carried = parts.moment[sliver] + parts.part[sliver, None] * apart
    np.add.at(moment, taker, share[:, None] * carried)
    place = np.cumsum(~gone) - 1
    stay = np.flatnonzero(~gone)
    links = (
        np.concatenate([stay, sliver]),
        np.concatenate([place[stay], place[taker]]),
        np.concatenate([np.ones(len(stay)), share]),
    )
    return Parts(parts.key[stay], part[stay], moment[stay]), links
