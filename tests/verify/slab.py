"""A slab of plane strain under a sudden pull, with a half-plane crack that grows: decks of cases.

The slab is under tension from the start, its ends are held and the crack appears: Freund's problem
without a wave from the loaded end. It is four cells thick.
"""

from __future__ import annotations

import numpy as np

from verify import Run, fill, run_deck
from verify.running import rayleigh_speed
from verify.solids import Solid

STEEL = Solid(2.0e5, 0.3, 7.85e-3)  # MPa, g/mm3
PULL = 100.0  # MPa
C_R = rayleigh_speed(STEEL)

DECK = """
*JOB slab
*UNITS length = mm, mass = g, time = ms
*PARAMETER
  h = @h@, w = @width@, tip = @tip@
*GRID size = h
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = @poisson@
*BODY block
  material = steel, box = -w 0 -w w 4*h w, stress = 0 0 @pull@ 0 0 0
*CRACK slit
  rectangle, along = 1 0 0, width = tip+w+2*h, across = 0 1 0, depth = 6*h
  centre = 0.5*(tip-w-2*h) 2*h 0.25*h
  ramp = 1, ramp_end = 0.5
*BOUNDARY plane = x -w, type = roller
*BOUNDARY plane = x w, type = roller
*BOUNDARY plane = z -w, type = fixed
*BOUNDARY plane = z w, type = fixed
*BOUNDARY plane = y 0, type = symmetry
*BOUNDARY plane = y 4*h, type = symmetry
*DAMPING pic = @pic@
*FRACTURE every = @every@, radii = 3*h 4*h, window = 2*h
*GROWTH criterion = straight, increment = @increment@, @law@
*TIME end = @end@
*OUTPUT particles = @particles@, crack = none, history = @every@
*HEALTH energy = 0
*END
"""


def run_slab(
    h: float,
    width: float,
    end: float,
    law: str,
    *,
    increment: float = 0.5,
    part: float = 0.1,
    particles: str = "none",
) -> Run:
    """Run a slab 2 `width` wide and high; `part` is the PIC part of a step."""
    deck = fill(
        DECK,
        h=h,
        width=width,
        tip=0.25 * h,
        density=STEEL.density,
        young=STEEL.young,
        poisson=STEEL.poisson,
        pull=PULL,
        pic=part * 2 * STEEL.c_d / h,
        every=0.5 * h / STEEL.c_d,
        increment=increment,
        law=law,
        end=end,
        particles=particles,
    )
    return run_deck(deck)


def history(run: Run, h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, ways of the tip and K_I: means over the points of the front."""
    table = run.table("front")
    times = np.unique(table["time"])
    means = [[table[name][table["time"] == time].mean() for time in times] for name in ("x", "K_I")]
    return times, np.array(means[0]) - 0.25 * h, np.array(means[1])
