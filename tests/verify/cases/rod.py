"""Square rod with an inclined quarter crack, pulled apart: section 5.3.2 of 10.1002/nme.6653.

The crack begins in mixed mode, K_II/K_I about 0.6, and must turn to mode I: half-way K_II is below
a tenth of K_I, which is a hundredth of G. Its front reaches all sides and locks there, so that none
is left; the surface covers the whole section: it lies over every column of particles. From then on
the halves are free bodies: the momentum of each grows with the load on its end, 400 MPa on 50 x 50
mm, and with nothing else. It is taken from the particles by the side of the crack that they are on,
so that a bond that is left, or a particle on the wrong side, shows; 1 % is what the load itself is
known to, on faces of particles.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, Run, run_deck
from verify.halves import before_and_after, columns, cut_time, pulls, shipped, uncovered
from xmpm_post import Run as Results

DENSITY, LOAD, SIDE, LENGTH = 7.9e-3, 400.0, 50.0, 100.0


def rows(full: bool) -> Iterator[Row]:
    """The rod at one size, or at three."""
    for h in (2.5, 2.0, 1.25) if full else (2.5, 2.0):
        yield from judge(run_deck(shipped("rod-quarter", h, 0.0525)), h)


def judge(run: Run, h: float) -> Iterator[Row]:
    """Rows of one run."""
    results = Results(run.folder, run.name)

    def row(what: str, value: float, reference: float, limit: float | None, error=None) -> Row:
        return Row.of("rod", "hoop", h, run, what, value, reference, limit, error)

    before, after = before_and_after(results)
    yield row("K_II/K_I at the beginning", before, 0.6, None)
    yield row("K_II/K_I half-way", after, 0.0, 0.1, after)
    time = cut_time(results)
    left = float(not time > 0)
    yield row("a front is left (0 or 1)", left, 0.0, 0.0, left)
    yield row("cut through at [us]", 1e3 * time, 40.0, None)
    bare = uncovered(results, columns(0.0, SIDE, h))
    yield row("section not covered", bare, 0.0, 0.0, bare)
    up, down = pulls(results, DENSITY * LENGTH * SIDE**2, LOAD * SIDE**2)
    yield row("upper half: momentum/impulse", up, 1.0, 0.01)
    yield row("lower half: momentum/impulse", down, -1.0, 0.01)
    balance = float(np.abs(results.energy["relative_error"]).max())
    yield row("balance of energy", balance, 0.0, 0.05, balance)
