"""The same crack elsewhere on the lattice, in a body that flies, in a body that turns.

Static: a penny-shaped crack in tension on lattice planes, 1e-6 h beside them, turned by 33
degrees, and by 20 degrees more about another axis. Wanted are what the case penny wants: 1 % for
the mean of K_I and 2.5 % at every point, with the effect of the box taken out.

Moving: a free block with an inclined crack, pulled at both ends. Flying through the grid at 0.1
c_d under a sudden load, K must be that of the block at rest. Turning by 30 degrees about the axis
of the load while this grows, it must be that of the block that does not turn; the centrifugal
stress is below 1 % of the load. The error is the rms of the difference, over the largest K_I for
all three modes; wanted is 2 %.
"""

import itertools
from collections.abc import Iterator

import numpy as np

from verify import Row, Run, fill, run_deck
from verify.cases.penny import K_0, RADIUS, STEEL, WIDTHS, make_deck
from verify.fronts import Front, K, box_factor, read_front, rms
from verify.solids import rotation

PULL, TURN = 1000.0, np.deg2rad(30.0)  # MPa

DECK = """
*JOB moving
*UNITS    length = mm, mass = g, time = ms
*PARAMETER
  h = @h@, l = @half@
*GRID     size = h, shape = @shape@
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = @poisson@
*BODY block
  material = steel, box = -l -l -l l l l, velocity = @velocity@, spin = 0 0 @spin@
*CRACK penny
  disc, centre = @centre@, along = cos(deg(30)) 0 -sin(deg(30)), across = 0 1 0, radius = @radius@
  element = 0.5*h
*LOAD     face = block:+z, traction = 0 0 @pull@, curve = ramp, rise = @rise@
*LOAD     face = block:-z, traction = 0 0 -@pull@, curve = ramp, rise = @rise@
*TIME     end = @end@
*HEALTH   energy = 0
*OUTPUT   particles = none, crack = opening
*FRACTURE every = @end@/40, cracks = penny, radii = 3*h 4*h 5*h
*END
"""


def places(h: float) -> dict[str, dict]:
    """Centre and frame of the static cracks."""
    x, y = np.eye(3)[:2]
    once = rotation(x, np.deg2rad(33.0))
    twice = rotation(y, np.deg2rad(20.0)) @ once
    return {
        "on lattice": {},
        "1e-6 h off": {"centre": np.full(3, 1e-6 * h)},
        "33 degrees": {"frame": once.T},  # rows: along, across, normal
        "33 and 20 deg": {"frame": twice.T},
    }


def static_rows(full: bool) -> Iterator[Row]:
    """Mean and worst point of K_I at each place."""
    box = None
    for cells in (6, 9, 12) if full else (6, 7, 8):
        h = RADIUS / cells
        for place, options in places(h).items():
            run = run_deck(make_deck(cells, WIDTHS[0], quarter=False, **options))
            ratio = read_front(run).k()[0] / K_0
            if box is None:
                wide = run_deck(make_deck(cells, WIDTHS[1], quarter=False, **options))
                box = box_factor(ratio.mean(), (read_front(wide).k()[0] / K_0).mean(), *WIDTHS)
            ratio = ratio / box
            yield Row.of("placement", place, h, run, "mean K_I / exact", ratio.mean(), 1.0, 0.01)
            worst = ratio[np.argmax(np.abs(ratio - 1))]
            yield Row.of("placement", place, h, run, "worst K_I / exact", worst, 1.0, 0.025)


def follow(
    cells: int,
    end: float,
    rise: float,
    velocity=(0.0, 0.0, 0.0),
    spin: float = 0.0,
    shape: str = "linear",
) -> tuple[Run, Front]:
    """Run a free block until `end`; times are in cells that a wave passes."""
    h = RADIUS / cells
    beat = h / STEEL.c_d
    deck = fill(
        DECK,
        h=h,
        shape=shape,
        half=h * round(2.5 * cells),
        density=STEEL.density,
        young=STEEL.young,
        poisson=STEEL.poisson,
        velocity=[v * STEEL.c_d for v in velocity],
        spin=spin / beat,
        centre=[0.13 * h, 0.27 * h, 0.41 * h],
        radius=RADIUS,
        pull=PULL,
        rise=rise * beat,
        end=end * beat,
    )
    run = run_deck(deck)
    return run, read_front(run)


def difference(moved: Front, still: Front) -> float:
    """Rms over times and points of the difference, the worst mode, over the largest K_I."""
    steps = min(len(moved.times), len(still.times))
    worst = max(rms(moved[name][:steps] - still[name][:steps]) for name in K)
    return worst / np.abs(still["K_I"]).max()


def moving_rows(full: bool) -> Iterator[Row]:
    """The block that flies and the block that turns against the block at rest."""
    for shape, cells in itertools.product(
        ("linear", "gimp"), (6, 9, 12, 16) if full else (6, 8, 10)
    ):
        end = 7.5 * cells  # three crossings of half the block
        _, still = follow(cells, end, 0.01, shape=shape)
        run, moved = follow(cells, end, 0.01, velocity=(0.07, 0.05, 0.05), shape=shape)
        yield moving_row("flying", shape, run, RADIUS / cells, difference(moved, still))
    for shape, cells in itertools.product(("linear", "gimp"), (4, 6, 9) if full else (4, 5, 6)):
        end = 100.0 * cells
        _, still = follow(cells, end, end, shape=shape)
        run, moved = follow(cells, end, end, spin=TURN / end, shape=shape)
        yield moving_row("turning", shape, run, RADIUS / cells, difference(moved, still))


def moving_row(motion: str, shape: str, run: Run, h: float, error: float) -> Row:
    """Row of one body that moves."""
    method = motion if shape == "linear" else f"{motion} {shape}"
    return Row.of("placement", method, h, run, "rms of K / K_I", error, 0.0, 0.02, error)


def rows(full: bool) -> Iterator[Row]:
    """All of them."""
    yield from static_rows(full)
    yield from moving_rows(full)
