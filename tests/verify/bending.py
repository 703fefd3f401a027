"""What is measured on a run of three-point bending: onset, growth and path of the crack."""

from __future__ import annotations

import numpy as np

from xmpm_post import Run

TIP = 50.0  # height of the front at the start [mm]


def onset_of(run: Run) -> float:
    """Time when the first front point moves [us]."""
    front = run.front
    moving = front["tip_speed"] > 0
    if not moving.any():
        return np.inf
    first = front["time"][moving].min()
    before = front["time"][front["time"] < first]
    return 1e3 * 0.5 * float(first + (before.max() if len(before) else first))


def tip_motion(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Times at which the crack was written, and the displacement of its tip (t,2)."""
    times = run.times("crack")
    motion = []
    for time in times:
        crack = run.crack(time)
        tip = int(np.argmax(crack.points[:, 1]))
        motion.append(crack.fields["displacement"][tip, :2])
    return times, np.array(motion)


def growth_of(run: Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [us], and the way of the front up and aside in the undeformed beam [mm]."""
    front = run.front
    times = np.array(front.values("time"))
    written, motion = tip_motion(run)
    mean = {}
    for k, name in enumerate("xy"):
        place = np.array([front[name][front["time"] == t].mean() for t in times])
        mean[name] = place - np.interp(times, written, motion[:, k])
    return 1e3 * times, mean["y"] - TIP, mean["x"]


def path_of(run: Run) -> np.ndarray:
    """Points (n,2) of the crack above its first front, from the bottom up, undeformed [mm]."""
    _, up, aside = growth_of(run)
    points = np.stack([aside, up + TIP], axis=1)
    rising = np.r_[True, points[1:, 1] > np.maximum.accumulate(points[:-1, 1])]
    return points[rising & (points[:, 1] >= TIP)]


def distance(one: np.ndarray, other: np.ndarray) -> float:
    """Largest distance of two paths across, over the heights that both have [mm]."""
    y = np.linspace(one[0, 1], min(one[-1, 1], other[-1, 1]), 100)
    across = np.interp(y, one[:, 1], one[:, 0]) - np.interp(y, other[:, 1], other[:, 0])
    return float(np.abs(across).max())
