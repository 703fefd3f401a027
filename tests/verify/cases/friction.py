"""Closed crack under compression and shear, with friction: slip, K_II, no overlap.

A slab of plane strain with a central crack of half-length a under the uniform stress -p across and
tau along it, held at its sides; the crack appears and the slab comes to rest. Friction takes mu p
of the shear, so that slip and K_II are (tau - mu p)/tau of the frictionless ones in the same slab:
the width drops out. Without friction K_II is tau sqrt(pi a), compared after the width of two slabs
is removed. Friction depends on the way, so nothing may overshoot: damping is above critical, and
XPIC(2) takes what no node sees. The opening must be 0, the faces overlap by 1e-3 h at most, and K
of a crack in tension be the same to 1e-6 with contact.
"""

from collections.abc import Iterator
from functools import cache

import numpy as np

from verify import Row, Run, fill, run_deck
from verify.solids import Solid
from xmpm_post import Run as Results

STEEL = Solid(2.0e5, 0.3, 7.9e-3)  # MPa, g/mm3
HALF, SHEAR, PRESSURE = 10.0, 60.0, 100.0  # mm, MPa
DAMPING = 5 * STEEL.c_s / HALF  # above critical [1/ms]

DECK = """
*JOB friction
*UNITS length = mm, mass = g, time = ms
*PARAMETER
  h = @h@, wide = @wide@, a = @half@
*GRID size = h
*MATERIAL steel
  law = elastic, density = @density@, young = @young@, poisson = @poisson@
*BODY slab
  material = steel, box = -wide -wide 0 wide wide h, stress = 0 @across@ 0 @shear@ 0 0
*CRACK slit
  rectangle, centre = 0 (h/2) (h/2), along = 0 0 1, across = 1 0 0, width = 5*h, depth = 2*a
  element = h, @contact@
*BOUNDARY plane = x -wide, type = fixed
*BOUNDARY plane = x wide, type = fixed
*BOUNDARY plane = y -wide, type = fixed
*BOUNDARY plane = y wide, type = fixed
*BOUNDARY plane = z 0, type = symmetry
*BOUNDARY plane = z h, type = symmetry
*TIME end = @end@, transfer = xpic
*DAMPING viscous = @damping@
*HEALTH energy = 0
*FRACTURE at = @end@, radii = 3*h 4*h 5*h
*OUTPUT particles = none, crack = opening
*END
"""


@cache
def follow(
    h: float,
    contact: str,
    wide: float = 30.0,
    across: float = -PRESSURE,
    shear: float = SHEAR,
) -> Run:
    """Run a slab to rest."""
    deck = fill(
        DECK,
        h=h,
        wide=wide,
        half=HALF,
        density=STEEL.density,
        young=STEEL.young,
        poisson=STEEL.poisson,
        across=across,
        shear=shear,
        contact=contact,
        damping=DAMPING,
        end=0.1,
    )
    return run_deck(deck)


def slip_of(run: Run) -> float:
    """Amplitude of the slip, as the shear stress that would cause it in an infinite body [MPa].

    Exact there is 4 (1 - nu**2)/E tau sqrt(a**2 - x**2); the best fit up to 0.8 a.
    """
    crack = Results(run.folder, run.name).crack()
    x, slip = crack.points[:, 0], crack.fields["opening"][:, 0]
    inner = np.abs(x) < 0.8 * HALF
    shape = np.sqrt(HALF**2 - x[inner] ** 2)
    amplitude = float((slip[inner] * shape).sum() / (shape**2).sum())
    return amplitude * STEEL.young / (4 * (1 - STEEL.poisson**2))


def slip_behind(run: Run, h: float) -> float:
    """Slip two cells behind the fronts, where K is split by openings [mm]."""
    crack = Results(run.folder, run.name).crack()
    x, slip = np.abs(crack.points[:, 0]), crack.fields["opening"][:, 0]
    return float(slip[np.abs(x - HALF + 2 * h) < 0.25 * h].mean())


def across(run: Run) -> np.ndarray:
    """Opening of the faces along the normal [mm]."""
    return Results(run.folder, run.name).crack().fields["opening"][:, 1]


def k_of(run: Run, mode: str) -> float:
    """Mean size of K over the front points [MPa sqrt(mm)]."""
    return float(np.abs(run.table("front")[mode]).mean())


def sliding(h: float, wanted: bool) -> Iterator[Row]:
    """A slab with friction against the same one without."""
    free = follow(h, "contact = frictionless")
    slip, k = slip_of(free), k_of(free, "K_II")
    for mu in (0.3, 0.5):
        run = follow(h, f"contact = friction, friction = {mu}")
        part = 1 - mu * PRESSURE / SHEAR
        case = ("friction", f"mu = {mu}", h, run)
        limit = 0.02 if wanted else None
        yield Row.of(*case, "slip / frictionless", slip_of(run) / slip, part, limit)
        yield Row.of(
            *case,
            "K_II / frictionless, from J",
            k_of(run, "K_II") / k,
            part,
            0.05 if wanted else None,
        )
        yield Row.of(
            *case,
            "K_II / frictionless, from the slip 2 h behind",
            slip_behind(run, h) / slip_behind(free, h),
            part,
            0.05 if wanted else None,
        )
        least, most = across(run).min() / h, across(run).max() / h
        yield Row.of(*case, "overlap [cells]", -least, 0.0, 1e-3, max(0.0, -least))
        yield Row.of(*case, "opening [cells]", most, 0.0, 1e-3, max(0.0, most))
        k_one = k_of(run, "K_I") / k
        yield Row.of(*case, "K_I / K_II", k_one, 0.0, 0.01, k_one)
        lost = float(np.abs(run.table("energy")["relative_error"]).max())
        yield Row.of(*case, "ledger", lost, 0.0, 0.05, lost)


def stuck(h: float) -> Iterator[Row]:
    """More friction than shear: nothing slips."""
    run = follow(h, "contact = friction, friction = 0.8")
    slip = slip_of(run) / SHEAR
    yield Row.of("friction", "mu = 0.8", h, run, "slip / infinite body's", slip, 0.0, 0.02, slip)


def frictionless(h: float) -> Iterator[Row]:
    """K_II without friction, from J and from the slip, the width of the slab removed.

    The sides disturb K by a part that goes with (a/width)**2.
    """
    near, far = follow(h, "contact = frictionless"), follow(h, "contact = frictionless", wide=60)
    root = np.sqrt(np.pi * HALF)
    for name, ks in (
        ("from J", [k_of(run, "K_II") for run in (near, far)]),
        ("from slip", [slip_of(run) * root for run in (near, far)]),
    ):
        alone = (4 * ks[1] - ks[0]) / 3
        yield Row.of("friction", "frictionless", h, far, f"K_II {name} [MPa sqrt(mm)]", alone,
                     SHEAR * root, 0.05)  # fmt: skip


def tension(h: float) -> Iterator[Row]:
    """K of a crack that is pulled open, with contact and without."""
    runs = [
        follow(h, f"contact = {how}", across=PRESSURE, shear=0.0)
        for how in ("none", "frictionless")
    ]
    one, other = (k_of(run, "K_I") for run in runs)
    what = "K_I with contact / without"
    yield Row.of("friction", "tension", h, runs[1], what, other / one, 1.0, 1e-6)


def rows(full: bool) -> Iterator[Row]:
    """Slip and K_II over their frictionless values, gaps, K in tension."""
    yield from sliding(2.0, wanted=False)
    yield from sliding(1.0, wanted=True)
    yield from stuck(1.0)
    yield from frictionless(1.0)
    yield from tension(2.0)
    yield from tension(1.0)
    if full:
        yield from sliding(0.5, wanted=True)
        yield from frictionless(0.5)
