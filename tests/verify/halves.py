"""What is measured where a crack cuts a body through: modes, surface, momentum of the halves."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from verify.driver import Row
from verify.measure import ROOT, RunError
from verify.measure import Run as Measured
from xmpm_post import Run

POISSON = 0.298  # of both decks
DENSITY, LOAD, LENGTH = 7.9e-3, 400.0, 100.0  # likewise; g/mm^3, MPa, mm


@dataclass(frozen=True)
class Body:
    """A body along z, pulled at both ends, that a crack cuts into two halves."""

    case: str  #: name of the case
    places: np.ndarray  #: (n,2) columns of its particles in the plane x, y
    section: float  #: area of a section [mm^2]
    mixed: float  #: K_II/K_I at the beginning, as expected
    cut: float  #: when no front is left, as expected [ms]


def judge_halves(body: Body, run: Measured, method: str, h: float) -> Iterator[Row]:
    """Rows that any such body has."""
    results = Run(run.folder, run.name)

    def row(what: str, value: float, reference: float, limit: float | None, error=None) -> Row:
        return Row.of(body.case, method, h, run, what, value, reference, limit, error)

    before, after = before_and_after(results)
    yield row("K_II/K_I at the beginning", before["II"], body.mixed, None)
    yield row("K_II/K_I half-way", after["II"], 0.0, 0.1, after["II"])
    limits = {"II": 0.01, "III": 0.01 if method == "schoellmann" else None}
    for mode, limit in limits.items():
        yield row(f"G_{mode}/G, beginning", before[f"G_{mode}"], 0.0, None, before[f"G_{mode}"])
        yield row(f"G_{mode}/G, half-way", after[f"G_{mode}"], 0.0, limit, after[f"G_{mode}"])
    time = cut_time(results)
    left = float(not time > 0)
    yield row("a front is left (0 or 1)", left, 0.0, 0.0, left)
    yield row("cut through at [us]", 1e3 * time, 1e3 * body.cut, None)
    bare = uncovered(results, body.places)
    yield row("section not covered", bare, 0.0, 0.0, bare)
    up, down = pulls(results, DENSITY * LENGTH * body.section, LOAD * body.section)
    yield row("upper half: momentum/impulse", up, 1.0, 0.01)
    yield row("lower half: momentum/impulse", down, -1.0, 0.01)
    balance = float(np.abs(results.energy["relative_error"]).max())
    yield row("balance of energy", balance, 0.0, 0.05, balance)
    closure = float(np.abs(results.energy["fracture_error"]).max())
    yield row("balance with G dA", closure, 0.0, 0.05, closure)


def shipped(name: str, h: float, end: float, criterion: str = "hoop") -> str:
    """A deck of input/ with other cells and another end, that also writes sides of particles."""
    deck = (ROOT / "input" / f"{name}.inp").read_text(encoding="utf-8")
    for pattern, text in (
        (r"(?m)^  h = [^,]*", f"  h = {h!r}"),
        (r"\*TIME end = [^,]*", f"*TIME end = {end!r}"),
        (r"displacement velocity stress", "velocity side"),
        (r"criterion = hoop", f"criterion = {criterion}"),
    ):
        deck, count = re.subn(pattern, text, deck)
        if count != 1:
            raise KeyError(f"{name}.inp: {count} places like {pattern}")
    return deck


def modes(run: Run) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray]:
    """Times, parts of the shear modes, and mean speed of the front.

    "II" is the rms of K_II over the rms of K_I along the fronts, "G_II" and "G_III" are what the
    modes have of the energy release rate.
    """
    front = run.front
    times = np.array(front.values("time"))
    parts = {name: np.full(len(times), np.nan) for name in ("II", "G_II", "G_III")}
    speed = np.zeros(len(times))
    for i, time in enumerate(times):
        rows = front.where(time=time)
        fits = rows["flags"].astype(int) % 2 == 0  # a domain lies within the material
        speed[i] = rows["tip_speed"].mean()
        if not (rows["K_I"][fits] > 0).any():
            continue
        square = [(rows[f"K_{mode}"][fits] ** 2).sum() for mode in ("I", "II", "III")]
        square[2] /= 1 - POISSON
        parts["II"][i] = np.sqrt(square[1] / square[0])
        parts["G_II"][i], parts["G_III"][i] = np.array(square[1:]) / sum(square)
    return times, parts, speed


def before_and_after(run: Run) -> tuple[dict[str, float], dict[str, float]]:
    """Parts of the shear modes when growth begins, and their means over its middle half."""
    times, parts, speed = modes(run)
    moving = np.flatnonzero(speed > 0)
    if not len(moving):
        raise RunError("the crack did not grow")
    first, last = times[moving[0]], times[-1]
    quarter = 0.25 * (last - first)
    middle = (times > first + quarter) & (times < last - quarter) & np.isfinite(parts["II"])
    before = {name: float(part[moving[0] - 1]) for name, part in parts.items()}
    return before, {name: float(part[middle].mean()) for name, part in parts.items()}


def cut_time(run: Run) -> float:
    """When the log says that no front is left; nan if it does not."""
    text = run.path(".log").read_text(encoding="utf-8")
    found = re.search(r"time (\S+): crack .*: no front is left", text)
    return float(found[1]) if found else np.nan


def after_cut(run: Run, what: str) -> list[float]:
    """Times after the cut at which particles, or the crack, were written."""
    times = [float(t) for t in run.times(what) if t > cut_time(run)]
    if len(times) < 2:
        raise RunError("fewer than two steps were written after the cut")
    return times


def columns(low: float, high: float, h: float) -> np.ndarray:
    """Places (n,2) of the particles of a square, two a cell and direction."""
    ticks = np.arange(low + h / 4, high, h / 2)
    return np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)


def uncovered(run: Run, places: np.ndarray) -> float:
    """Part of places (n,2) in the plane x, y without the crack above or below, after the cut."""
    crack = run.crack(after_cut(run, "crack")[0])
    corners = crack.points[crack.triangles][:, :, :2]
    over = np.zeros(len(places), dtype=bool)
    for a, b, c in corners:
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        near = np.flatnonzero(~over & (places >= low).all(axis=1) & (places <= high).all(axis=1))
        if not len(near):
            continue
        p = places[near]
        turn = [cross(q - o, p - o) for o, q in ((a, b), (b, c), (c, a))]
        inside = np.all([t >= -1e-9 for t in turn], 0) | np.all([t <= 1e-9 for t in turn], 0)
        over[near[inside]] = True
    return float(1 - over.mean())


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Third component of the product of vectors in the plane."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def rims(run: Run) -> int:
    """Number of closed lines that bound the crack surface."""
    triangles = run.crack().triangles
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges, count = np.unique(np.sort(pairs), axis=0, return_counts=True)
    group: dict[int, int] = {}

    def root(v: int) -> int:
        while group.setdefault(v, v) != v:
            v = group[v]
        return v

    for a, b in edges[count == 1].tolist():
        group[root(a)] = root(b)
    return len({root(v) for v in list(group)})


def pulls(run: Run, mass: float, force: float) -> tuple[float, float]:
    """Rate of the axial momentum of the upper and lower half over a force, after the cut.

    Both halves are then free bodies, whose momentum grows with the force on their ends alone.
    `mass` is that of the body; particles share it alike, though those at a round wall are cut.
    Near the crack a particle knows its side, of which either may be above; far from it its
    place tells, over or under those of its column that know.
    """
    times = after_cut(run, "particles")
    momenta = []
    for time in (times[0], times[-1]):
        p = run.particles(time)
        side = np.asarray(p.fields["side"], dtype=float)
        up = np.sign(p.points[side > 0, 2].mean() - p.points[side < 0, 2].mean())
        upper = np.where(np.abs(side) > 0, up * side, height_over(p.points, side)) > 0
        axial = mass / len(side) * p.fields["velocity"][:, 2]
        momenta.append((axial[upper].sum(), axial[~upper].sum()))
    span = force * (times[-1] - times[0])
    up, down = (float(b - a) / span for a, b in zip(*momenta, strict=True))
    return up, down


def height_over(x: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Height of particles (n,3) over the mean of those of their column that know their side."""
    low = x[:, :2].min(axis=0)
    steps = ((x[:, :2] - low) / (np.ptp(x[:, :2], axis=0) / 20 + 1e-9)).astype(int)
    column = 20 * steps[:, 0] + steps[:, 1]
    knows = np.abs(side) > 0
    count = np.bincount(column[knows], minlength=400)
    total = np.bincount(column[knows], x[knows, 2], minlength=400)
    return x[:, 2] - (total / np.maximum(count, 1))[column]
