"""Spinning bar: centrifugal stress at its middle, and its angular momentum.

A bar with a Poisson ratio of 0 turns about the axis through its middle. It starts unstretched, so
its stress swings about the exact sigma(x) = rho w^2 (L^2/4 - x^2)/2; the mean over two whole
periods 2 L/c is compared. The angular momentum drifts since particles take the change of nodes with
a lumped mass; the drift is reported.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, fill, run_deck

LENGTH, WIDTH, DENSITY, YOUNG, OMEGA = 40.0, 4.0, 1.0e-3, 1.0e3, 5.0  # mm, g/mm3, MPa, 1/ms
SPEED = (YOUNG / DENSITY) ** 0.5  # mm/ms

DECK = """
*JOB spin
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = @h@
*GRID     size = h, shape = @shape@
*MATERIAL soft
  law = elastic, density = @density@, young = @young@, poisson = 0
*BODY bar
  material = soft, particles = 2
  box = @x0@ @y0@ @y0@ @x1@ @y1@ @y1@
  spin = 0 0 @omega@
*PROBE middle
  point = 0.1*h 0.1*h 0.1*h, quantity = stress
*TIME     end = @end@, cfl = 0.5
*HEALTH   energy = 0
*OUTPUT   every = @end@, history = @end@/400
*END
"""


def rows(full: bool) -> Iterator[Row]:
    """Mean of the stress along the bar at its middle over two swings."""
    end = 4.0 * LENGTH / SPEED
    exact = DENSITY * OMEGA**2 * LENGTH**2 / 8.0
    for shape in ("linear", "gimp"):
        for h in (2.0, 1.0, 0.5) if full else (2.0, 1.0):
            deck = fill(
                DECK,
                h=h,
                shape=shape,
                density=DENSITY,
                young=YOUNG,
                omega=OMEGA,
                x0=-0.5 * LENGTH,
                x1=0.5 * LENGTH,
                y0=-0.5 * WIDTH,
                y1=0.5 * WIDTH,
                end=end,
            )
            run = run_deck(deck)
            probe = run.table("probe")
            # Along the bar, which has turned by w t.
            c, s = np.cos(OMEGA * probe["time"]), np.sin(OMEGA * probe["time"])
            along = c * c * probe["middle_xx"] + s * s * probe["middle_yy"]
            along += 2.0 * c * s * probe["middle_xy"]
            # The gradient at free sides is off by a part of the spin, so the error is of first
            # order in h over the width: 12.6 and 6.4 % (linear), 7.0 and 3.1 % (GIMP) with 2 and
            # 4 cells over it (recorded on 2026-11-22).
            limit = 0.28 * h / WIDTH
            yield Row.of("spin", shape, h, run, "mean stress [MPa]", along.mean(), exact, limit)
            turns = run.table("energy")["angular_z"]
            yield Row.of(
                "spin", shape, h, run, "angular momentum [g mm2/ms]", turns[-1], turns[0], None
            )
