"""A half-plane crack that drives itself after a sudden pull, against the exact law of its tip.

K_ID = K_Ic/(1 - C/C_R) (eq. 59 and 60 of 10.1002/nme.6653) with K_I = k_I(C) K_0(t) (Freund 1990)
gives onset and way of the tip exactly. Cells of 1 and 0.5 mm, onset at 20 mm/c_d, until the tip has
gone 10 mm, up to 0.39 C_R: onset within 2 %, the way within 10 % (aim: 3 %); with increments of
0.25, 0.5 and 1 cells within 1 % of each other.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row
from verify.running import time_of, toughness_for
from verify.slab import PULL, STEEL, history, run_slab

ONSET = 20.0 / STEEL.c_d  # ms
WAY = 10.0  # mm


def rows(full: bool) -> Iterator[Row]:
    """Two sizes and three increments; with `full` also a quarter of a cell's size."""
    toughness = toughness_for(PULL, ONSET, STEEL)
    end = time_of(WAY, PULL, toughness, STEEL)
    half = time_of(0.5 * WAY, PULL, toughness, STEEL)
    width = float(np.ceil(0.5 * STEEL.c_d * end) + 2)
    law = f"law = running, toughness = {toughness!r}"
    sizes = (1.0, 0.5, 0.25) if full else (1.0, 0.5)
    cases = [(1.0, 0.25), (1.0, 1.0), *((h, 0.5) for h in sizes)]
    ways = {}
    for h, increment in cases:
        run = run_slab(h, width, 1.01 * end, law, increment=increment)
        times, way, k = history(run, h)
        after = int(np.argmax(k >= toughness))
        onset = np.interp(toughness, k[after - 1 : after + 1], times[after - 1 : after + 1])
        method = f"increment {increment}"
        there = float(np.interp(end, times, way))
        yield Row.of("growth", method, h, run, "onset [us]", 1e3 * onset, 1e3 * ONSET, 0.02)
        reached = float(np.interp(half, times, way))
        yield Row.of("growth", method, h, run, "way half-way [mm]", reached, 0.5 * WAY, 0.1)
        yield Row.of("growth", method, h, run, "way [mm]", there, WAY, 0.03)
        ways[h, increment] = there
    ways = [way for (h, _), way in ways.items() if h == 1.0]
    spread = (max(ways) - min(ways)) / WAY
    yield Row.of("growth", "increments", 1.0, run, "spread of the way", spread, 0.0, 0.01, spread)
