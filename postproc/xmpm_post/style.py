"""Look of the figures: sized for a column or a page of a journal."""

from __future__ import annotations

from itertools import cycle
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

COLUMN, PAGE = 3.35, 6.9  # inches
# Colours that the colour-blind tell apart (Okabe and Ito), and that differ in print without them.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = "osD^vP<>"
LOOK = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "legend.frameon": False,
    "mathtext.fontset": "dejavusans",
    "pdf.fonttype": 42,
    "savefig.dpi": 300,
}
# What the deck's units make of a stress, where it has a name.
STRESS = {
    "m kg s": "Pa",
    "mm g ms": "MPa",
    "mm t s": "MPa",
    "mm kg ms": "GPa",
    "um mg us": "GPa",
    "cm g us": "Mbar",
}
SYMBOLS = {
    "J": "$J$",
    "K_I": r"$K_\mathrm{I}$",
    "K_II": r"$K_\mathrm{II}$",
    "K_III": r"$K_\mathrm{III}$",
    "T": "$T$",
    "K_star": "$K^*$",
    "kink_angle": "kink angle",
    "tip_speed": "tip speed",
    "time": "$t$",
    "s": "$s$",
}


def unit_text(name: str, unit: str, system: str) -> str:
    """Unit in brackets, with the name of the stress where it has one."""
    length, stress = system.split(" ")[0], STRESS.get(system)
    if stress and name.startswith("K_") and not name.startswith("K_star_"):
        unit = rf"{stress} $\sqrt{{\mathrm{{{length}}}}}$"
    elif stress and name == "J":
        unit = f"{stress} {length}"
    elif stress and name == "T":
        unit = stress
    return f" [{unit}]" if unit not in ("", "1") else ""


def label_of(name: str, unit: str = "", system: str = "") -> str:
    """Label of an axis."""
    return SYMBOLS.get(name, name.replace("_", " ")) + unit_text(name, unit, system)


def panels(count: int, columns: int = 2, height: float = 2.1) -> tuple[Figure, list]:
    """A figure with so many panels in rows; a single one has the width of a column."""
    columns = min(columns, count)
    rows = -(-count // columns)
    width = PAGE if columns > 1 else COLUMN
    figure = plt.figure(figsize=(width, height * rows), layout="constrained")
    return figure, [figure.add_subplot(rows, columns, i + 1) for i in range(count)]


def looks():
    """Colour and marker of one curve after the other."""
    return zip(cycle(COLOURS), cycle(MARKERS), strict=False)


def save(figure: Figure, path: Path) -> Path:
    """Write a figure and forget it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    plt.close(figure)
    return path
