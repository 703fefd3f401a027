"""`xmpm-post k`: stress intensity factors over time and along the front."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from xmpm_post import style
from xmpm_post.errors import PostError, names
from xmpm_post.run import Run
from xmpm_post.table import Table, read_table

QUANTITIES = ("K_I", "K_II", "K_III", "J")
# Bits of the column `flags`.
FLAGS = {
    1: "no domain fits into the body",
    2: "another crack in the domain",
    4: "boundary condition in the domain",
    8: "end of the front",
    16: "faces closed",
    32: "smaller radius used",
}
MANY = 30  # more points than this have a band for their error, fewer have bars


def choose_front(table: Table, crack: str | None, front: int | None) -> Table:
    """Rows of one front: the first one unless named."""
    if len(table) == 0:
        raise PostError(f"{table.source}: no rows; *FRACTURE asked for no time of the run")
    table = table.where(crack=crack if crack is not None else table.values("crack")[0])
    return table.where(front=front if front is not None else table.values("front")[0])


def choose_points(table: Table, points: list[int] | None) -> list[float]:
    """Numbers of the points that are followed: four over the length of the front unless named."""
    there = table.values("point")
    if points is None:
        places = np.linspace(0, len(there) - 1, min(4, len(there)))
        return [there[round(p)] for p in places]
    for point in points:
        if point not in there:
            raise PostError(
                f"{table.source}: no point {point}; this front has {there[0]:g} to {there[-1]:g}"
            )
    return points


def choose_times(table: Table, times: list[float] | None) -> list[float]:
    """Times of the table nearest to those wanted: three over its length unless named."""
    there = np.array(table.values("time"))
    if times is None:
        places = np.linspace(0, len(there) - 1, min(4, len(there)))[-3:]
        return [float(there[round(p)]) for p in places]
    return list(dict.fromkeys(float(there[np.argmin(np.abs(there - t))]) for t in times))


def read_references(paths: list[Path], quantities: tuple[str, ...]) -> list[Table]:
    """Reference curves: a column `time` or `s`, and columns of quantities."""
    tables = [read_table(path) for path in paths]
    for table in tables:
        if not ("time" in table or "s" in table) or not any(q in table for q in quantities):
            raise PostError(
                f"{table.source}: a reference needs a column time or s and one of "
                f"{names(quantities)}; it has {names(table.columns)}"
            )
    return tables


def with_error(panel, x, rows: Table, quantity: str, **look) -> None:
    """A curve with its error: bars for few points, a band for many."""
    y = rows[quantity]
    low, high = f"{quantity}_low", f"{quantity}_high"
    colour = look["color"]
    if low not in rows or high not in rows:
        panel.plot(x, y, **look)
    elif len(x) > MANY:
        panel.fill_between(x, rows[low], rows[high], color=colour, alpha=0.2, linewidth=0)
        panel.plot(x, y, **look | {"marker": None})
    else:
        below, above = np.maximum(y - rows[low], 0), np.maximum(rows[high] - y, 0)
        panel.errorbar(x, y, [below, above], capsize=1.5, elinewidth=0.6, **look)


def with_references(panel, references: list[Table], axis: str, quantity: str) -> None:
    """Reference curves of a panel, black and dashed."""
    for table, dashes in zip(references, ("--", ":", "-.") * len(references), strict=False):
        if axis in table and quantity in table:
            order = np.argsort(table[axis], kind="stable")
            name = table.provenance.get("label", "reference")
            panel.plot(
                table[axis][order], table[quantity][order], "k", ls=dashes, lw=0.9, label=name
            )


def finish(figure, axes: list, table: Table, axis: str, quantities: tuple[str, ...]) -> None:
    """Labels of all panels, one legend below them."""
    system = table.provenance.get("unit_system", "")
    for panel, quantity in zip(axes, quantities, strict=True):
        panel.set_xlabel(style.label_of(axis, table.unit(axis), system))
        panel.set_ylabel(style.label_of(quantity, table.unit(quantity), system))
        panel.axhline(0, color="0.7", lw=0.5, zorder=0)
    curves = {}
    for panel in axes:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            curves.setdefault(label, handle)
    figure.legend(
        curves.values(), curves.keys(), loc="outside lower center", ncols=min(4, len(curves))
    )


def draw_history(table: Table, points, quantities, references, path: Path) -> Path:
    """Quantities against time at some points of a front."""
    figure, axes = style.panels(len(quantities))
    for point, (colour, marker) in zip(points, style.looks(), strict=False):
        rows = table.where(point=point)
        name = f"point {point:g}, $s$ = {rows['s'][0]:.4g}"
        for panel, quantity in zip(axes, quantities, strict=True):
            with_error(panel, rows["time"], rows, quantity, color=colour, marker=marker, label=name)
    for panel, quantity in zip(axes, quantities, strict=True):
        with_references(panel, references, "time", quantity)
    finish(figure, axes, table, "time", quantities)
    return style.save(figure, path)


def draw_along(table: Table, times, quantities, references, path: Path) -> Path:
    """Quantities along a front at some times; points with flags are hollow."""
    figure, axes = style.panels(len(quantities))
    flagged = False
    for time, (colour, marker) in zip(times, style.looks(), strict=False):
        rows = table.where(time=time)
        rows = rows.keep(np.argsort(rows["s"], kind="stable"))
        marked = rows["flags"] > 0 if "flags" in rows else np.zeros(len(rows), bool)
        flagged |= bool(marked.any())
        for panel, quantity in zip(axes, quantities, strict=True):
            with_error(
                panel, rows["s"], rows, quantity,
                color=colour, marker=None if marked.any() else marker, label=f"$t$ = {time:.4g}",
            )  # fmt: skip
            panel.plot(rows["s"][marked], rows[quantity][marked], marker, color=colour, mfc="white")
            if marked.any():
                panel.plot(rows["s"][~marked], rows[quantity][~marked], marker, color=colour)
    for panel, quantity in zip(axes, quantities, strict=True):
        with_references(panel, references, "s", quantity)
    if flagged:
        axes[0].plot([], [], "o", color="0.4", mfc="white", label="flagged")
    finish(figure, axes, table, "s", quantities)
    return style.save(figure, path)


def said_of_flags(table: Table) -> str:
    """How many rows have which flag, in words."""
    if "flags" not in table:
        return ""
    bits = table["flags"].astype(int)
    parts = [
        f"{text} {np.sum(bits & bit > 0)}" for bit, text in FLAGS.items() if (bits & bit).any()
    ]
    return f" of {len(table)} rows have flags: {', '.join(parts)}" if parts else ""


def draw_k(
    run: Run,
    folder: Path,
    kind: str = "pdf",
    crack: str | None = None,
    front: int | None = None,
    points: list[int] | None = None,
    times: list[float] | None = None,
    quantities: tuple[str, ...] = QUANTITIES,
    references: tuple[Path, ...] = (),
) -> list[str]:
    """Both figures of a front; what was written, a line each."""
    table = choose_front(run.front, crack, front)
    for quantity in quantities:
        _ = table[quantity]
    given = read_references(list(references), quantities)
    points, times = choose_points(table, points), choose_times(table, times)
    said = []
    with plt.rc_context(style.LOOK):
        if len(table.values("time")) > 1:
            path = folder / f"{run.name}_k_time.{kind}"
            said.append(str(draw_history(table, points, quantities, given, path)))
        path = folder / f"{run.name}_k_front.{kind}"
        said.append(str(draw_along(table, times, quantities, given, path)))
    flags = said_of_flags(table)
    return said + (
        [f"crack {table['crack'][0]}, front {table['front'][0]:g}:{flags}"] if flags else []
    )
