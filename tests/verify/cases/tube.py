"""Tube with an inclined crack through its wall, pulled apart: section 5.3.3 of 10.1002/nme.6653.

Both fronts begin in mixed mode and must turn to mode I: half-way K_II is below a tenth of K_I, a
hundredth of G. They run round the tube and meet on the other side, at 180 degrees from the slit
within a cell of the mean radius: turned by 180 degrees about its radius the slit is itself, so that
none of the fronts may be ahead. They come beside each other, 10 mm apart along the axis as the ends
of the slit are, and are joined. Then no front is left, the surface is one ring with an inner and an
outer rim that lies over every column of particles of the wall, and the halves are free bodies: the
momentum of each grows with the load on its end and with nothing else; 1 % is what the load itself
is known to, on a ring of cubes.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, Run, run_deck
from verify.halves import before_and_after, columns, cut_time, pulls, rims, shipped, uncovered
from xmpm_post import Run as Results

DENSITY, LOAD, LENGTH = 7.9e-3, 400.0, 100.0
INNER, OUTER = 35.0, 45.0


def rows(full: bool) -> Iterator[Row]:
    """The tube at one size, or at three."""
    for h in (2.5, 2.0, 1.25) if full else (2.5, 2.0):
        yield from judge(run_deck(shipped("tube-crack", h, 0.085)), h)


def meeting(results: Results) -> float:
    """Angle around the axis between the slit and where the fronts were seen last [degrees]."""
    front = results.front
    rows = front.where(time=front["time"].max())
    angles = np.arctan2(rows["y"], rows["x"])
    ahead = [np.mean(angles[rows["front"] == f] % (2 * np.pi)) for f in np.unique(rows["front"])]
    return float(np.degrees(np.mean(ahead)))


def judge(run: Run, h: float) -> Iterator[Row]:
    """Rows of one run."""
    results = Results(run.folder, run.name)

    def row(what: str, value: float, reference: float, limit: float | None, error=None) -> Row:
        return Row.of("tube", "hoop", h, run, what, value, reference, limit, error)

    before, after = before_and_after(results)
    yield row("K_II/K_I at the beginning", before, 1.0, None)
    yield row("K_II/K_I half-way", after, 0.0, 0.1, after)
    time = cut_time(results)
    left = float(not time > 0)
    yield row("a front is left (0 or 1)", left, 0.0, 0.0, left)
    yield row("fronts met at [us]", 1e3 * time, 70.0, None)
    yield row("fronts met at [degrees]", meeting(results), 180.0, np.degrees(h / 40) / 180)
    yield row("rims of the ring", float(rims(results)), 2.0, 0.0)
    places = columns(-OUTER, OUTER, h)
    radius = np.hypot(*places.T)
    bare = uncovered(results, places[(radius > INNER) & (radius < OUTER)])
    yield row("wall not covered", bare, 0.0, 0.0, bare)
    section = np.pi * (OUTER**2 - INNER**2)
    up, down = pulls(results, DENSITY * LENGTH * section, LOAD * section)
    yield row("upper half: momentum/impulse", up, 1.0, 0.01)
    yield row("lower half: momentum/impulse", down, -1.0, 0.01)
    balance = float(np.abs(results.energy["relative_error"]).max())
    yield row("balance of energy", balance, 0.0, 0.05, balance)
