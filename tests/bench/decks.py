"""Decks of the benchmarks."""

from __future__ import annotations

from verify import fill

# A block of 40 x 40 x 40 cells with 8 particles each. It flies and spins, so that after some steps
# the particles stand anywhere in their cells and about one in a hundred changes its cell in a step.
BLOCK = """
*JOB block
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  young = 2.0e5, density = 7.9e-3, c = sqrt(young/density)
*GRID     size = 1, shape = @shape@
*MATERIAL steel
  law = elastic, density = density, young = young, poisson = 0.3
*BODY block
  material = steel, particles = 2
  box = 0.5 0.5 0.5 40.5 40.5 @height@
  velocity = 0.010*c 0.008*c 0.006*c
  spin = 0 0.0005*c 0.001*c, spin_centre = 20 20 20
*TIME     end = 1, scheme = musl, cfl = 0.5, steps = @steps@
*OUTPUT   every = 1, particles = velocity
*HEALTH   energy = 0
*END
"""

# The plates of section 5.1 of the paper, 480,000 particles. Results are written at the end only.
PLATE = """
*JOB plate
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = 2, slope = atan(2)
*GRID     size = h, shape = linear
*MATERIAL alloy
  law = elastic, density = 1.5e-3, young = 100e3, poisson = 0.33
*BODY plate
  material = alloy, particles = 2
  box = -200 -60 -5 200 60 5
@cracks@
*LOAD     face = plate:+x, traction = 100 0 0, curve = step
*LOAD     face = plate:-x, traction = -100 0 0, curve = step
*TIME     end = 0.025, scheme = musl, cfl = 0.5@steps@
*OUTPUT   every = 0.025, particles = velocity
*END
"""

CRACK = """*CRACK slit-@number@
  rectangle, centre = @x@ 0 0, along = cos(slope) sin(slope) 0, width = 40
  across = 0 0 1, depth = 12"""

# Places of the cracks along the plate [mm]; the paper's spacing is 200 and 100 mm.
PLACES = {
    0: (),
    1: (0.0,),
    2: (-100.0, 100.0),
    4: (-150.0, -50.0, 50.0, 150.0),
}


def block(shape: str, steps: int, height: int = 40) -> str:
    """Flying block; half the height is half the particles."""
    return fill(BLOCK, shape=shape, steps=steps, height=height + 0.5)


def plate(cracks: int, steps: int | None = None) -> str:
    """Plate with 0, 1, 2 or 4 cracks, for its 25 us or for a number of steps."""
    places = enumerate(PLACES[cracks], 1)
    text = "\n".join(fill(CRACK, number=number, x=x) for number, x in places)
    return fill(PLATE, cracks=text, steps="" if steps is None else f", steps = {steps}")
