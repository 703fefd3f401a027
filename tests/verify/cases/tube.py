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

from verify import Row, run_deck
from verify.halves import Body, columns, judge_halves, rims, shipped
from xmpm_post import Run as Results

INNER, OUTER = 35.0, 45.0


def rows(full: bool) -> Iterator[Row]:
    """The tube at one size, or at three."""
    for h in (2.5, 2.0, 1.25) if full else (2.5, 2.0):
        yield from judge(h)


def meeting(results: Results) -> float:
    """Angle around the axis between the slit and where the fronts were seen last [degrees]."""
    front = results.front
    rows = front.where(time=front["time"].max())
    angles = np.arctan2(rows["y"], rows["x"])
    ahead = [np.mean(angles[rows["front"] == f] % (2 * np.pi)) for f in np.unique(rows["front"])]
    return float(np.degrees(np.mean(ahead)))


def judge(h: float) -> Iterator[Row]:
    """Rows of a run."""
    run = run_deck(shipped("tube-crack", h, 0.085))
    places = columns(-OUTER, OUTER, h)
    radius = np.hypot(*places.T)
    wall = places[(radius > INNER) & (radius < OUTER)]
    body = Body("tube", wall, section=np.pi * (OUTER**2 - INNER**2), mixed=1.0, cut=0.070)
    yield from judge_halves(body, run, "hoop", h)
    results = Results(run.folder, run.name)
    limit = np.degrees(h / 40) / 180
    yield Row.of("tube", "hoop", h, run, "fronts met at [degrees]", meeting(results), 180.0, limit)
    yield Row.of("tube", "hoop", h, run, "rims of the ring", float(rims(results)), 2.0, 0.0)
