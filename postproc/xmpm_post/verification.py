"""`xmpm-post verify`: error against CPU seconds, one curve a method."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogFormatter

from xmpm_post import style
from xmpm_post.errors import PostError
from xmpm_post.table import Table, read_table


def series(rows: Table) -> dict[str, list[Table]]:
    """Rows with errors and costs that a logarithmic axis can show, by quantity and then method."""
    shown = rows.keep((rows["error"] > 0) & (rows["cpu_s"] > 0) & np.isfinite(rows["error"]))
    found = {}
    if len(shown):
        for quantity in shown.values("quantity"):
            part = shown.where(quantity=quantity)
            found[quantity] = [part.where(method=method) for method in part.values("method")]
    return found


def draw_panel(panel, quantity: str, methods: list[Table]) -> None:
    """Error against cost of one quantity, with the limits and the cell sizes."""
    for rows, (colour, marker) in zip(methods, style.looks(), strict=False):
        rows = rows.keep(np.lexsort((rows["cpu_s"], -rows["h"])))
        panel.plot(
            rows["cpu_s"], rows["error"], color=colour, marker=marker, label=rows["method"][0]
        )
        for cost, error, size in zip(rows["cpu_s"], rows["error"], rows["h"], strict=True):
            panel.annotate(
                f"{size:g}", (cost, error), xytext=(3, 3), textcoords="offset points",
                fontsize=5.5, color=colour,
            )  # fmt: skip
        limits = limit_of(rows)
        if np.isfinite(limits).any():
            panel.plot(rows["cpu_s"], limits, color=colour, ls=":", lw=0.8, marker="_")
    panel.set(xscale="log", yscale="log", title=quantity, xlabel="CPU time [s]", ylabel="error")
    for axis in (panel.xaxis, panel.yaxis):  # 0.01, and 0.02 where that is the only one
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(1, 0.4)))
    panel.margins(0.15)
    panel.legend()


def limit_of(rows: Table) -> np.ndarray:
    """Limits, nan where a row has none."""
    limit = rows["limit"]
    if limit.dtype.kind == "f":
        return limit
    return np.array([float(v) if v else np.nan for v in limit])


def draw_verification(path: Path, folder: Path, kind: str = "pdf", cases=None) -> list[str]:
    """A figure a case with a panel a quantity; the names of the files."""
    table = read_table(path)
    for name in ("case", "method", "h", "quantity", "error", "limit", "cpu_s"):
        _ = table[name]
    if len(table) == 0:
        raise PostError(f"{path}: no rows")
    said = []
    for case in cases or table.values("case"):
        found = series(table.where(case=case))
        if not found:
            said.append(f"{case}: no errors above zero with CPU times to draw")
            continue
        with plt.rc_context(style.LOOK):
            figure, axes = style.panels(len(found), height=2.3)
            for panel, (quantity, methods) in zip(axes, found.items(), strict=True):
                draw_panel(panel, quantity, methods)
            figure.suptitle(f"{case} (numbers: cell size; dotted: limit)", fontsize=8)
            said.append(str(style.save(figure, folder / f"verification_{case}.{kind}")))
    return said
