"""Cylinder with an inclined penny-shaped crack under tension: section 5.2.1 of 10.1002/nme.6653.

Radius 50 mm, length 90 mm, a crack of radius 10 mm in its middle whose normal is 30 degrees off
the axis, 40 MPa. The stress is there from the start, with the load at both ends, and the crack
appears: the body relaxes to rest. References: eq. 63-65 (K_I/K_0 = 0.750, K_II up to 0.509, K_III
up to 0.357 with K_0 = 2 sigma sqrt(a/pi) = 4.51 MPa sqrt(m)); the finite radius adds 0.5 %, which
is left in. Wanted are 3 % for all modes.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, fill, run_deck
from verify.fronts import amplitudes, read_front, rms
from verify.solids import Solid, penny_k, tension

SOLID = Solid(20.0e3, 0.298, 7.9e-3)  # MPa, g/mm3
RADIUS, LENGTH, PULL = 10.0, 90.0, 40.0  # mm, MPa
SLOPE = np.deg2rad(30.0)
NORMAL = np.array([np.sin(SLOPE), 0.0, np.cos(SLOPE)])
K_0 = 2 * PULL * np.sqrt(RADIUS / np.pi)

DECK = """
*JOB cylinder
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = @h@
*GRID     size = h
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = @poisson@
*BODY rod
  material = steel, cylinder = 0 0 -45 0 0 45 50, stress = 0 0 @pull@ 0 0 0
*CRACK penny
  disc, centre = 0 0 0, along = @along@, across = 0 1 0, radius = @radius@, element = 0.5*h
*LOAD     face = rod:+z, traction = 0 0 @pull@
*LOAD     face = rod:-z, traction = 0 0 -@pull@
*TIME     end = @end@
*DAMPING  viscous = @rate@
*OUTPUT   particles = none, crack = opening
*FRACTURE at = @end@, cracks = penny, radii = 3*h 4*h 5*h
*END
"""


def rows(full: bool) -> Iterator[Row]:
    """Amplitude of each mode, the worst difference and its rms along the front."""
    along = np.array([np.cos(SLOPE), 0.0, -np.sin(SLOPE)])  # along x across = normal
    for h in (2.5, 2.0, 1.0) if full else (20 / 7, 2.5, 2.0):
        deck = fill(
            DECK,
            h=h,
            density=SOLID.density,
            young=SOLID.young,
            poisson=SOLID.poisson,
            pull=PULL,
            along=along,
            radius=RADIUS,
            end=15 * LENGTH / SOLID.c_d,
            rate=2 * SOLID.c_d / LENGTH,
        )
        run = run_deck(deck)
        front = read_front(run)
        exact = penny_k(
            tension(PULL, np.array([0.0, 0.0, 1.0])), NORMAL, np.zeros(3), RADIUS,
            front.points[-1], SOLID.poisson,
        )  # fmt: skip
        ratio = amplitudes(front.k(), exact)
        for mode, name in enumerate(("I", "II", "III")):
            peak = np.abs(exact[mode]).max() / K_0
            yield Row.of(
                "cylinder", "graded", h, run, f"K_{name} / K_0, amplitude", ratio[mode] * peak,
                peak, 0.03,
            )  # fmt: skip
        error = max(map(rms, front.k() - exact)) / K_0
        yield Row.of("cylinder", "graded", h, run, "rms / K_0, worst mode", error, 0.0, None, error)
