"""`xmpm-post energy`: energies and the error of their balance over time."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from xmpm_post import style
from xmpm_post.errors import PostError
from xmpm_post.run import Run

PARTS = ("kinetic", "strain", "external", "damping", "transfer", "plastic", "contact", "fracture",
         "unresolved")  # fmt: skip


def draw_energy(run: Run, folder: Path, kind: str = "pdf") -> list[str]:
    """The figure; what was written and the largest error, a line each."""
    table = run.energy
    if len(table) == 0:
        raise PostError(f"{table.source}: no rows")
    system = table.provenance.get("unit_system", "")
    with plt.rc_context(style.LOOK):
        figure = plt.figure(figsize=(style.COLUMN, 3.4), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
        for part, (colour, _) in zip(PARTS, style.looks(), strict=False):
            if part in table and np.any(table[part] != 0):
                upper.plot(table["time"], table[part], color=colour, label=part)
        upper.set_ylabel(style.label_of("energy", table.unit("kinetic"), system))
        upper.legend()
        lower.axhline(0, color="0.7", lw=0.5)
        lower.plot(table["time"], 100 * table["relative_error"], color=style.COLOURS[-1])
        if "fracture_error" in table and np.any(table["fracture_error"] != 0):
            lower.plot(table["time"], 100 * table["fracture_error"], "k--", label="with fracture")
            lower.legend()
        lower.set_ylabel("balance error [%]")
        lower.set_xlabel(style.label_of("time", table.unit("time"), system))
        path = style.save(figure, folder / f"{run.name}_energy.{kind}")
    worst = int(np.argmax(np.abs(table["relative_error"])))
    error, time = 100 * table["relative_error"][worst], table["time"][worst]
    return [str(path), f"largest error of the balance: {error:.3g} % at t = {time:.6g}"]
