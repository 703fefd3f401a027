"""Bar under a sudden pull: displacement at its middle over one period, order in h.

The bar is fixed at x = 0 and pulled by sigma at x = L from t = 0 on. With a Poisson ratio of 0 it
moves in one dimension, and d'Alembert's solution is a sum of fronts: the k-th sets out from the
pulled end at 2 k L / c, is reflected by the wall with the same stress, and by the end with the
opposite.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, fill, run_deck

LENGTH, DENSITY, YOUNG, PULL = 100.0, 7.9e-3, 2.0e5, 100.0  # mm, g/mm3, MPa, MPa
SPEED = (YOUNG / DENSITY) ** 0.5  # mm/ms
PERIOD = 4.0 * LENGTH / SPEED

DECK = """
*JOB bar-wave
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = @h@
*GRID     size = h, shape = @shape@
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = 0
*BODY bar
  material = steel, particles = 2
  box = 0 0 0 @length@ 2*h 2*h
*BOUNDARY plane = x 0, type = fixed
*LOAD     face = bar:+x, traction = @pull@ 0 0, curve = step
*PROBE middle
  point = 0.5*@length@+0.25*h 0.75*h 0.75*h, quantity = displacement
*TIME     end = @period@, cfl = 0.5
*OUTPUT   every = @period@, history = @period@/200
*END
"""


def displacement(x: float, t: np.ndarray) -> np.ndarray:
    """Exact displacement along the bar [mm]."""
    u = np.zeros_like(t)
    for k in range(3):
        start = 2 * k * LENGTH / SPEED
        there = np.maximum(0.0, t - start - (LENGTH - x) / SPEED)
        back = np.maximum(0.0, t - start - (LENGTH + x) / SPEED)
        u += (-1.0) ** k * (there - back)
    return PULL / (DENSITY * SPEED) * u


def rows(full: bool) -> Iterator[Row]:
    """Rms of the difference over the rms of the displacement."""
    for shape in ("linear", "gimp"):
        for h in (5.0, 2.5, 1.25, 0.625) if full else (5.0, 2.5, 1.25):
            deck = fill(
                DECK,
                h=h,
                shape=shape,
                density=DENSITY,
                young=YOUNG,
                length=LENGTH,
                pull=PULL,
                period=PERIOD,
            )
            run = run_deck(deck)
            probe = run.table("probe")
            exact = displacement(0.5 * LENGTH + 0.25 * h, probe["time"])
            u = probe["middle_x"]
            error = np.sqrt(np.mean((u - exact) ** 2) / np.mean(exact**2))
            # A front is spread over a few cells: half the rise is lost over 2 h of the bar.
            limit = 0.5 * h / LENGTH
            yield Row.of(
                "bar-wave",
                shape,
                h,
                run,
                "largest displacement [mm]",
                u.max(),
                exact.max(),
                limit,
                float(error),
            )
