"""Penny-shaped crack at rest: straight in tension at four sizes, and inclined off the lattice.

The block is under a uniform stress from the start, its outer nodes are held, and the crack
appears: what relaxes is the disturbance by the crack alone. The holding lowers K by a part that
goes with the cube of radius over half-width; it is measured with a second, wider box and taken
out. References: eq. 63-65 of 10.1002/nme.6653.

Straight: in tension, on a plane of the lattice, also with GIMP. Wanted are 1 % for the mean of
K_I and 2.5 % at every point. Inclined: the load 30 degrees off the crack's normal, five centres and
directions, full blocks; wanted are 3 % for the amplitude of each mode and 2 % of K_0 for the rms
of the difference along the front. The rules of the paper for the front and its contour stand
beside, without a limit, and so does a quarter of the block between symmetry planes, at whose ends
the domains are cut.
"""

from collections.abc import Iterator

import numpy as np

from verify import Row, Run, fill, run_deck
from verify.fronts import amplitudes, box_factor, read_front, rms
from verify.solids import Solid, penny_k, rotation, tension, voigt

STEEL = Solid(2.0e5, 0.3, 7.9e-3)  # MPa, g/mm3
RADIUS, PULL = 12.0, 100.0  # mm, MPa
WIDTHS = (3.0, 4.5)  # half-widths over the radius, the second for the effect of the box
UPRIGHT = np.eye(3)
K_0 = 2 * PULL * np.sqrt(RADIUS / np.pi)

HEAD = """
*JOB penny
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = @h@, l = @half@
*GRID     size = h, shape = @shape@
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = @poisson@
*CRACK penny
  disc, centre = @centre@, along = @along@, across = @across@, radius = @radius@
  front = @rule@, element = 0.5*h
*BOUNDARY plane = x l, type = fixed
*BOUNDARY plane = y l, type = fixed
*BOUNDARY plane = z l, type = fixed
*BOUNDARY plane = z -l, type = fixed
*RELAX    method = kinetic, residual = 1e-3, limit = @limit@
*TIME     end = @limit@, steps = 0
*OUTPUT   particles = none, crack = opening
*FRACTURE at = 0, cracks = penny, methods = @method@, radii = 3*h 4*h 5*h
"""

QUARTER = """
*BODY block
  material = steel, box = 0 0 -l l l l, stress = @stress@
*BOUNDARY plane = x 0, type = symmetry
*BOUNDARY plane = y 0, type = symmetry
*END
"""

WHOLE = """
*BODY block
  material = steel, box = -l -l -l l l l, stress = @stress@
*BOUNDARY plane = x -l, type = fixed
*BOUNDARY plane = y -l, type = fixed
*END
"""


def make_deck(
    cells: int,
    width: float,
    *,
    quarter: bool = True,
    rule: str = "graded",
    method: str = "domain",
    centre: np.ndarray | tuple = (0.0, 0.0, 0.0),
    frame: np.ndarray = UPRIGHT,
    stress: np.ndarray | None = None,
    shape: str = "linear",
) -> str:
    """Deck with so many cells in the radius; `frame` has the crack's along, across, normal."""
    h = RADIUS / cells
    half = h * round(width * cells)
    if stress is None:
        stress = tension(PULL, frame[2])
    return fill(
        HEAD + (QUARTER if quarter else WHOLE),
        h=h,
        shape=shape,
        half=half,
        density=STEEL.density,
        young=STEEL.young,
        poisson=STEEL.poisson,
        centre=centre,
        along=frame[0],
        across=frame[1],
        radius=RADIUS,
        rule=rule,
        limit=100 * half / STEEL.c_d,
        method=method,
        stress=voigt(stress),
    )


def straight(
    cells: int, width: float, quarter: bool = False, **options: str
) -> tuple[Run, np.ndarray]:
    """Run a crack in tension; K_I along the front over its exact value."""
    deck = make_deck(cells, width, quarter=quarter, **options)
    run = run_deck(deck)
    return run, read_front(run).k()[0] / K_0


def two_rows(method: str, cells: int, run: Run, ratio: np.ndarray, limits: tuple) -> Iterator[Row]:
    """Mean and worst point of K_I over its exact value."""
    h = RADIUS / cells
    yield Row.of("penny", method, h, run, "mean K_I / exact", ratio.mean(), 1.0, limits[0])
    worst = ratio[np.argmax(np.abs(ratio - 1))]
    yield Row.of("penny", method, h, run, "worst K_I / exact", worst, 1.0, limits[1])


def inclined(number: int, cells: int, width: float) -> tuple[Run, np.ndarray, np.ndarray]:
    """Run a crack somewhere; the run, K (3,n) and the exact K (3,n)."""
    chance = np.random.default_rng(number)
    frame = rotation(chance.normal(size=3), chance.uniform(0, np.pi))
    centre = chance.uniform(-0.5, 0.5, 3) * RADIUS / cells
    slope, around = np.deg2rad(30.0), chance.uniform(0, 2 * np.pi)
    aside = np.cos(around) * frame[0] + np.sin(around) * frame[1]
    stress = tension(PULL, np.cos(slope) * frame[2] + np.sin(slope) * aside)
    deck = make_deck(cells, width, quarter=False, centre=centre, frame=frame, stress=stress)
    run = run_deck(deck)
    front = read_front(run)
    exact = penny_k(stress, frame[2], centre, RADIUS, front.points[-1], STEEL.poisson)
    return run, front.k(), exact


def straight_rows(box: float, full: bool) -> Iterator[Row]:
    """Tension: mean and worst point of K_I by size, with the box's effect taken out."""
    for cells in (6, 9, 12, 16) if full else (6, 9, 12):
        run, ratio = straight(cells, WIDTHS[0])
        yield from two_rows("graded", cells, run, ratio / box, (0.01, 0.025))
    cheap = (6, 9) if full else (6,)
    for cells in cheap:
        run, ratio = straight(cells, WIDTHS[0], shape="gimp")
        yield from two_rows("gimp", cells, run, ratio / box, (0.01, 0.025))
    for cells in (6, 9, 12, 16) if full else (6, 9, 12):
        run, ratio = straight(cells, WIDTHS[0], quarter=True)
        yield from two_rows("quarter", cells, run, ratio / box, (None, None))
    for rule in ("node", "full", "cut"):
        for cells in cheap:
            run, ratio = straight(cells, WIDTHS[0], rule=rule)
            yield from two_rows(rule, cells, run, ratio / box, (None, None))
    for method in ("contour", "paper"):
        for cells in cheap:
            run, ratio = straight(cells, WIDTHS[0], method=method)
            yield from two_rows(method, cells, run, ratio / box, (None, None))


def inclined_rows(full: bool) -> Iterator[Row]:
    """Inclined: the worst of five places for the amplitude of each mode and for the rms."""
    _, near, exact = inclined(1, 6, WIDTHS[0])
    _, far, exact_far = inclined(1, 6, WIDTHS[1])
    pairs = zip(amplitudes(near, exact), amplitudes(far, exact_far), strict=True)
    box = np.array([box_factor(a, b, *WIDTHS) for a, b in pairs])
    for cells in (6, 8, 12) if full else (6, 8):
        h, found = RADIUS / cells, []
        for number in range(1, 6):
            run, k, exact = inclined(number, cells, WIDTHS[0])
            k = k / box[:, None]
            found.append((run, amplitudes(k, exact), max(map(rms, k - exact)) / K_0))
        for mode, name in enumerate(("I", "II", "III")):
            run, ratio, _ = max(found, key=lambda f, m=mode: abs(f[1][m] - 1))
            what = f"K_{name} / exact, worst of 5"
            yield Row.of("penny", "inclined", h, run, what, ratio[mode], 1.0, 0.03)
        run, _, error = max(found, key=lambda f: f[2])
        yield Row.of(
            "penny", "inclined", h, run, "rms / K_0, worst mode of 5", error, 0.0, 0.02, error
        )


def rows(full: bool) -> Iterator[Row]:
    """All of them; the box first."""
    run, near = straight(6, WIDTHS[0])
    _, far = straight(6, WIDTHS[1])
    box = box_factor(near.mean(), far.mean(), *WIDTHS)
    yield Row.of("penny", "graded", RADIUS / 6, run, "box: K(3a) / K(inf)", box, 1.0, None)
    yield from straight_rows(box, full)
    yield from inclined_rows(full)
