"""Cracks that cut a body through: when, by which modes, with a picture of the surface."""

from __future__ import annotations

from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np

from reproduction.study import Done, Result, Study
from xmpm_post import style
from xmpm_post.surface import draw_crack


def cut_through(study: Study, done: Done, printed: float | None) -> Iterator[Result]:
    """End of the growth, share of the shear modes before and after it began, balance; figures."""
    run = done.results
    front = run.front
    times, shear, speed = history(done)
    moving = np.flatnonzero(speed > 0)
    start = moving[0] if len(moving) else len(times) - 1
    end = "cut through" if "cut" in run.path(".log").read_text(encoding="utf-8") else "not cut"
    last = 1e3 * float(front["time"].max())
    yield study.result(done, f"{end}: last front [us]", last, printed, "figure 24" * bool(printed))
    yield study.result(done, "shear modes in G before growth", shear[max(start - 1, 0)])
    # Modes are taken where half of the body is still whole: later the parts swing freely.
    half = start + (len(times) - start) // 2
    share = float(np.median(shear[half : half + 3]))
    yield study.result(
        done, "shear modes in G half-way; error: itself", share, 0.0, "mode I", share
    )
    error = float(np.abs(run.energy["relative_error"]).max())
    yield study.result(done, "balance of energy", error, 0.0, "energy", error)
    draw_crack(run, study.picture("surface"), renderer="matplotlib")
    draw_modes(study, times, shear, speed, start)


def history(done: Done) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [us], mean share of modes II and III in G, and mean speed over the front [m/s]."""
    front = done.results.front
    times = np.array(front.values("time"))
    shear, speed, total = np.zeros((3, len(times)))
    for i, time in enumerate(times):
        rows = front.where(time=time)
        k = np.stack([rows[name] for name in ("K_I", "K_II", "K_III")])
        square = (k**2).sum(axis=0)
        total[i] = square.sum()
        shear[i] = total[i] and (k[1:] ** 2).sum() / total[i]
        speed[i] = rows["tip_speed"].mean()
    # Before the wave has come the share is that of rounding.
    return 1e3 * times, np.where(total > 1e-6 * total.max(), shear, np.nan), speed


def draw_modes(
    study: Study, times: np.ndarray, shear: np.ndarray, speed: np.ndarray, start: int
) -> None:
    """Share of the shear modes and speed of the front over time; growth begins at `start`."""
    with plt.rc_context(style.LOOK):
        figure, axes = style.panels(2)
        for panel, values, label in (
            (axes[0], 100 * shear, "shear modes in $\\sum K^2$ [%]"),
            (axes[1], speed, "mean speed of the front [m/s]"),
        ):
            panel.axvline(times[start], color="0.7", lw=0.5, label="growth begins")
            panel.plot(times, values, ".-", color=style.COLOURS[0])
            panel.set(xlabel=r"$t$ [$\mu$s]", ylabel=label, xlim=(0, None), ylim=(0, None))
        axes[0].legend()
        style.save(figure, study.picture("modes"))
