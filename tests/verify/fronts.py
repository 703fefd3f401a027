"""Rows of NAME_front.csv as arrays over time and point, and what the cases measure on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.measure import Run, RunError

K = ("K_I", "K_II", "K_III")


@dataclass(frozen=True)
class Front:
    """Fracture parameters along one front over time."""

    times: np.ndarray  #: (t,)
    points: np.ndarray  #: (t,n,3) places of the points
    columns: dict[str, np.ndarray]  #: (t,n) all other columns with numbers

    def __getitem__(self, name: str) -> np.ndarray:
        """Column of a name (t,n)."""
        return self.columns[name]

    def k(self, step: int = -1) -> np.ndarray:
        """K_I, K_II, K_III (3,n) at a time, the last by default."""
        return np.array([self.columns[name][step] for name in K])


def read_front(run: Run) -> Front:
    """The only front of a run, with the same points at all times."""
    table = run.table("front")
    times = np.unique(table["time"])
    if len(times) == 0 or len(table["time"]) % len(times):
        raise RunError(f"{run.folder}: {len(table['time'])} rows at {len(times)} times")
    if len({(c, f) for c, f in zip(table["crack"], table["front"], strict=True)}) != 1:
        raise RunError(f"{run.folder}: more than one front")
    order = np.lexsort((table["point"], table["time"]))
    shape = (len(times), -1)
    columns = {
        name: column[order].reshape(shape)
        for name, column in table.items()
        if column.dtype.kind == "f"
    }
    points = np.stack([columns["x"], columns["y"], columns["z"]], axis=-1)
    return Front(times, points, columns)


def amplitudes(found: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Amplitude of each mode over its exact one (3,): the best fit along the front."""
    square = np.sum(exact**2, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(square > 0, np.sum(found * exact, axis=1) / square, np.nan)


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def box_factor(near: float, far: float, near_width: float, far_width: float) -> float:
    """What the box makes of K at `near_width`, from the K found at two half-widths.

    A penny-shaped crack disturbs the far field by its opening, as a dipole: a boundary at a
    distance w changes K by a part that goes with 1/w**3. Then K(w) = K (1 - c/w**3).
    """
    p, q = near_width**-3, far_width**-3
    c = (far - near) / (far * p - near * q)
    return 1 - c * p
