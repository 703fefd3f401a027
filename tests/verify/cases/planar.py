"""A crack that grows on a plane tilted to the grid, at a prescribed speed.

By 20 cells, through corners of the grid's blocks. Its surface must stay within 0.1 h of the plane,
and what it does must be the same on one rank and on two: the way of the tip at all times and the
surface at the end, to rounding.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, fill, run_deck
from xmpm_post import Run as Results

SLOPE, SPEED = np.arctan(0.3), 900.0  # rad, m/s

DECK = """
*JOB plate
*UNITS length = mm, mass = g, time = ms
*PARAMETER
  h = @h@, slope = @slope@, v = @speed@
*GRID size = h
*MATERIAL steel
  law = elastic, density = 7.85e-3, young = 200e3, poisson = 0.3
*BODY block
  material = steel, box = -15*h -3*h -6*h 24*h 3*h 14*h, stress = 0 0 50 0 0 0
*CRACK slit
  rectangle, centre = -10*h 0 0, along = cos(slope) 0 sin(slope), width = 14*h
  across = 0 1 0, depth = 8*h, ramp = 1, ramp_end = 0.5
*FRACTURE every = h/v, radii = 3*h
*GROWTH criterion = straight, law = speed, speed = v, increment = @increment@
*TIME end = 20*h/v
*OUTPUT history = 2*h/v, particles = none
*END
"""


def rows(full: bool) -> Iterator[Row]:
    """One size and two increments; with `full` two sizes."""
    for h in (1.0, 0.5) if full else (1.0,):
        for increment in (0.5, 1.0):
            yield from judge(h, increment)


def judge(h: float, increment: float) -> Iterator[Row]:
    """Rows of an increment, on one rank and on two."""
    deck = fill(DECK, h=h, slope=float(SLOPE), speed=SPEED, increment=increment)
    runs = [run_deck(deck, ranks=ranks) for ranks in (1, 2)]
    surfaces = [Results(run.folder, run.name).crack().points for run in runs]
    tables = [run.table("front") for run in runs]
    method = f"increment {increment}"
    along = np.array([np.cos(SLOPE), 0, np.sin(SLOPE)])
    across = np.array([-np.sin(SLOPE), 0, np.cos(SLOPE)])
    start = np.array([-10 * h, 0, 0])
    off = float(np.abs((surfaces[0] - start) @ across).max() / h)
    yield Row.of("planar", method, h, runs[0], "off the plane [h]", off, 0.0, 0.1, off)
    last = tables[0]["time"] == tables[0]["time"].max()
    tip = np.array([tables[0][name][last] for name in "xyz"]).T - start
    way = float(np.mean(tip @ along) - 7 * h) / h
    yield Row.of("planar", method, h, runs[0], "way [h]", way, 20.0, 0.005)
    same = all(len(tables[0][name]) == len(tables[1][name]) for name in "xyz")
    miss = np.inf
    if same and surfaces[0].shape == surfaces[1].shape:
        miss = max(float(np.abs(tables[0][name] - tables[1][name]).max()) for name in "xyz")
        miss = max(miss, float(np.abs(surfaces[0] - surfaces[1]).max())) / h
    yield Row.of("planar", method, h, runs[1], "off that of one rank [h]", miss, 0.0, 1e-9, miss)
