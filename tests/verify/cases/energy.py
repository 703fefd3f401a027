"""Energy after 5000 undamped steps: plate under tension and free block, with and without a crack.

The balance takes kinetic energy, stress work, work of the loads each from its own rate; what it
lacks is a column of its own, over the largest energy so far. The staggered measure swings, so the
mean of the last tenth of the run is compared with 0.
"""

from collections.abc import Iterator

from verify import Row, fill, run_deck

PLATE = """
*JOB plate
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = 10
*GRID     size = h, shape = @shape@
*MATERIAL alloy
  law = elastic, density = 1.5e-3, young = 100e3, poisson = 0.33
*BODY plate
  material = alloy, particles = 2
  box = -200 -60 -10  200 60 10
@crack@
*LOAD     face = plate:+x, traction = 100 0 0, curve = step
*LOAD     face = plate:-x, traction = -100 0 0, curve = step
*TIME     end = 100, steps = 5000, cfl = 0.5
*HEALTH   energy = 0
*OUTPUT   every = 100, history = 1e-3, particles = none, crack = none
*END
"""

SLIT = """*CRACK slit
  rectangle, centre = 0 0 0, along = 1 2 0, width = 60, across = 0 0 1, depth = 60"""

BLOCK = """
*JOB block
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = 1
*GRID     size = h, shape = @shape@
*MATERIAL soft
  law = elastic, density = 1e-3, young = 1e3, poisson = 0.3
*BODY block
  material = soft, particles = 2
  box = -5 -5 -5  5 5 5
  stress = 0 0 @start@ 0 0 0
@crack@
*TIME     end = 1000, steps = 5000, cfl = 0.5
*HEALTH   energy = 0
*OUTPUT   every = 1000, history = 0.01, particles = none, crack = none
*END
"""

PENNY = """*CRACK penny
  disc, centre = 0.1 0.2 0.15, along = 1 0 0, across = 0 1 0.2, radius = 2.5"""


def rows(full: bool) -> Iterator[Row]:
    """Mean error of the balance over the last tenth of the steps."""
    del full
    for shape in ("linear", "gimp"):
        for name, text, h, crack in (
            ("plate", fill(PLATE, shape=shape, crack=""), 10.0, False),
            ("plate, slit", fill(PLATE, shape=shape, crack=SLIT), 10.0, True),
            ("block", fill(BLOCK, shape=shape, crack="", start=1.0), 1.0, False),
            ("block, penny", fill(BLOCK, shape=shape, crack=PENNY, start=1.0), 1.0, True),
        ):
            del crack
            run = run_deck(text)
            error = run.table("energy")["relative_error"]
            last = float(error[-max(1, len(error) // 10) :].mean())
            what = f"{name}: energy lost"
            yield Row.of("energy", shape, h, run, what, last, 0.0, 0.03, abs(last))
