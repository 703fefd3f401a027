"""What is measured where a crack cuts a body through: modes, surface, momentum of the halves."""

from __future__ import annotations

import re

import numpy as np

from verify.measure import ROOT, RunError
from xmpm_post import Run


def shipped(name: str, h: float, end: float) -> str:
    """A deck of input/ with other cells and another end, that also writes sides of particles."""
    deck = (ROOT / "input" / f"{name}.inp").read_text(encoding="utf-8")
    for pattern, text in (
        (r"(?m)^  h = [^,]*", f"  h = {h!r}"),
        (r"\*TIME end = [^,]*", f"*TIME end = {end!r}"),
        (r"displacement velocity stress", "velocity side"),
    ):
        deck, count = re.subn(pattern, text, deck)
        if count != 1:
            raise KeyError(f"{name}.inp: {count} places like {pattern}")
    return deck


def modes(run: Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, rms of K_II over rms of K_I along the fronts, and mean speed of the front."""
    front = run.front
    times = np.array(front.values("time"))
    ratio, speed = np.full(len(times), np.nan), np.zeros(len(times))
    for i, time in enumerate(times):
        rows = front.where(time=time)
        fits = rows["flags"].astype(int) % 2 == 0  # a domain lies within the material
        speed[i] = rows["tip_speed"].mean()
        if (rows["K_I"][fits] > 0).any():
            ratio[i] = np.sqrt((rows["K_II"][fits] ** 2).sum() / (rows["K_I"][fits] ** 2).sum())
    return times, ratio, speed


def before_and_after(run: Run) -> tuple[float, float]:
    """K_II over K_I when growth begins, and its mean over the middle half of the growth."""
    times, ratio, speed = modes(run)
    moving = np.flatnonzero(speed > 0)
    if not len(moving):
        raise RunError("the crack did not grow")
    first, last = times[moving[0]], times[-1]
    quarter = 0.25 * (last - first)
    middle = (times > first + quarter) & (times < last - quarter) & np.isfinite(ratio)
    return float(ratio[moving[0] - 1]), float(ratio[middle].mean())


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
    place tells.
    """
    times = after_cut(run, "particles")
    momenta = []
    for time in (times[0], times[-1]):
        p = run.particles(time)
        side = np.asarray(p.fields["side"], dtype=float)
        up = np.sign(p.points[side > 0, 2].mean() - p.points[side < 0, 2].mean())
        upper = np.where(np.abs(side) > 0, up * side, p.points[:, 2]) > 0
        axial = mass / len(side) * p.fields["velocity"][:, 2]
        momenta.append((axial[upper].sum(), axial[~upper].sum()))
    span = force * (times[-1] - times[0])
    up, down = (float(b - a) / span for a, b in zip(*momenta, strict=True))
    return up, down
