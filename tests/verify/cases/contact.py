"""Bodies that meet: two elastic cubes head-on at any gap and time step, and a block that slides.

The cubes must never hold more than 102 % of their first energy; momentum is exact. The block
slides on a rigid table under its weight, v = v0 - mu g t.
"""

from collections.abc import Iterator

from verify import Row, fill, run_deck

CUBES = """
*JOB cubes
*UNITS    length = mm, mass = g, time = ms
*PARAMETER half = @gap@/2
*GRID     size = 1, shape = @shape@, origin = 0.1 0 0
*MATERIAL soft
  law = elastic, density = 1e-3, young = 1e3, poisson = 0.3
*BODY left
  material = soft, box = -5-half -2.5 -2.5  -half 2.5 2.5, velocity = 10 0 0
*BODY right
  material = soft, box = half -2.5 -2.5  5+half 2.5 2.5, velocity = -10 0 0
*CONTACT  bodies = left right
*TIME     end = 0.03+@gap@/20, cfl = @cfl@
*HEALTH   energy = 0
*OUTPUT   every = 1, history = 2e-4, particles = none
*END
"""

BLOCK = """
*JOB block
*UNITS    length = m, mass = kg, time = s
*GRID     size = @h@, shape = @shape@, origin = 0 0.03 0
*MATERIAL stuff
  law = elastic, density = 1000, young = 1e6, poisson = 0.3
*BODY table
  material = stuff, box = -0.5 -0.2 -0.3  1 0 0.3, rigid, held = xyz
*BODY block
  material = stuff, box = -0.2 0 -0.2  0.2 0.2 0.2, velocity = 1 0 0
*CONTACT  bodies = table block, friction = 0.3 @normal@
*GRAVITY  acceleration = 0 -10 0
*TIME     end = 0.25
*HEALTH   energy = 0
*OUTPUT   every = 1, history = 0.01, particles = none
*END
"""


def cubes(full: bool) -> Iterator[Row]:
    """Largest energy over the first, and momentum over that of one cube."""
    steps = (0.5, 0.1, 0.02) if full else (0.5, 0.1)
    for shape in ("linear", "gimp"):
        for cfl in steps:
            for gap in (0.5, 0.9, 1.3, 2.0):
                run = run_deck(fill(CUBES, gap=gap, shape=shape, cfl=cfl))
                energy = run.table("energy")
                total = (energy["kinetic"] + energy["strain"]) / energy["kinetic"][0]
                what = f"gap {gap} cfl {cfl}: most energy"
                most = float(total.max())
                yield Row.of("contact", shape, 1.0, run, what, most, 1.0, 0.02, max(0.0, most - 1))
                drift = float(abs(energy["momentum_x"]).max()) / 1.25
                what = f"gap {gap} cfl {cfl}: momentum"
                yield Row.of("contact", shape, 1.0, run, what, drift, 0.0, 1e-12, drift)
                lost = float(energy["relative_error"][-1])
                what = f"gap {gap} cfl {cfl}: ledger"
                yield Row.of("contact", shape, 1.0, run, what, lost, 0.0, 0.05, abs(lost))


def rows(full: bool) -> Iterator[Row]:
    """Cubes, and the speed of a sliding block."""
    yield from cubes(full)
    for name, normal, limit in (("normal given", ", normal = 0 1 0", 0.02), ("found", "", 0.1)):
        run = run_deck(fill(BLOCK, shape="linear", h=0.1, normal=normal))
        energy = run.table("energy")
        lost = float(1 - energy["momentum_x"][-1] / 32)
        time = float(energy["time"][-1])
        what = f"block, {name}: speed lost"
        yield Row.of("contact", "linear", 0.1, run, what, lost, 3 * time, limit)
