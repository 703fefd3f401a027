"""`xmpm-post crack`: the surfaces of the cracks with their fronts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from xmpm_post.errors import PostError, names
from xmpm_post.render import (
    BAR,
    choose_renderer,
    faces_of,
    limits,
    look,
    quiet_vtk,
    surface_of,
    tilted_view,
    vertex_normals,
)
from xmpm_post.run import Run

SIZE = (1200, 1000)  # pixels


@dataclass
class Scene:
    """What is drawn."""

    points: np.ndarray  # (m,3) vertices of the cracks
    triangles: np.ndarray  # (k,3) vertices of the triangles
    values: np.ndarray  # (m,) that colour them
    label: str  # of the colours
    fronts: list  # (n,3) points of each front
    along: list  # (n,) values along each front, or None
    along_label: str  # of the fronts' colours
    view: np.ndarray  # (3,) towards the eye
    up: np.ndarray  # (3,) upright in the picture
    title: str
    length: str  # unit of the points, in brackets, or nothing


def front_values(run: Run, time: float, quantity: str) -> tuple[list, list, str]:
    """Points of all fronts and a quantity along them, from NAME_front.csv; closed ones closed."""
    rows = run.front.where(time=time)
    lines, values = [], []
    for crack in rows.values("crack"):
        for front in rows.where(crack=crack).values("front"):
            part = rows.where(crack=crack, front=front)
            points = np.stack([part["x"], part["y"], part["z"]], axis=1)
            value = part[quantity]
            steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
            gap = np.linalg.norm(points[-1] - points[0])
            if len(points) > 3 and 0 < gap < 2 * steps.max():
                points, value = np.vstack([points, points[:1]]), np.append(value, value[0])
            lines.append(points)
            values.append(value)
    return lines, values, f"{quantity} [{run.front.unit(quantity)}]"


def make_scene(run: Run, time: float | None, field: str, quantity: str | None) -> Scene:
    """Everything that is drawn, from the run's files."""
    crack = surface_of(run.crack(time))
    if field not in crack.fields:
        raise PostError(f"{crack.source}: no field {field}; there are: {names(crack.fields)}")
    values = crack.fields[field]
    if values.ndim == 2:
        values = np.linalg.norm(values, axis=1)
    fronts, along, label = [crack.points[line] for line in crack.lines], [], ""
    if quantity is not None:
        fronts, along, label = front_values(run, crack.time, quantity)
    _, areas = vertex_normals(crack.points, crack.triangles)
    view, up = tilted_view(areas, crack.points)
    unit = crack.units.get(field, "")
    length, time_unit = run.units
    return Scene(
        points=crack.points,
        triangles=crack.triangles,
        values=values,
        label=field.replace("_", " ") + (f" [{unit}]" if unit not in ("", "1") else ""),
        fronts=fronts,
        along=along or [None] * len(fronts),
        along_label=label,
        view=view,
        up=up,
        title=f"{run.name}, t = {crack.time:.6g} {time_unit}".rstrip(),
        length=f" [{length}]" if length else "",
    )


def draw_with_pyvista(scene: Scene, path: Path) -> None:
    """Draw with VTK off the screen."""
    import pyvista

    quiet_vtk()
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE, border=False)
    plotter.set_background("white")
    mesh = pyvista.PolyData(scene.points, faces_of(scene.triangles))
    mesh["values"] = scene.values
    plotter.add_mesh(
        mesh,
        scalars="values",
        cmap="viridis",
        clim=limits(scene.values),
        lighting=False,
        show_edges=len(scene.triangles) < 5000,
        edge_opacity=0.2,
        scalar_bar_args=BAR | {"title": scene.label + "\n"},
    )
    colours = limits(np.concatenate([v for v in scene.along if v is not None] or [np.zeros(1)]))
    upper = BAR | {"title": scene.along_label + "\n", "position_y": 0.86}
    for line, values in zip(scene.fronts, scene.along, strict=True):
        if values is None:
            plotter.add_lines(line, color="red", width=6, connected=True)
            continue
        front = pyvista.lines_from_points(line)
        front["along"] = values
        plotter.add_mesh(
            front, scalars="along", cmap="plasma", clim=colours, line_width=9, lighting=False,
            scalar_bar_args=upper,
        )  # fmt: skip
    plotter.add_text(scene.title, position="upper_left", font_size=11, color="black")
    look(plotter, scene.points, scene.view, scene.up, SIZE[0] / SIZE[1])
    plotter.screenshot(path)
    plotter.close()


def draw_with_matplotlib(scene: Scene, path: Path) -> None:
    """Draw without VTK's rendering."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import MaxNLocator

    figure = plt.figure(figsize=(SIZE[0] / 150, SIZE[1] / 150), dpi=150, layout="constrained")
    panel = figure.add_subplot(projection="3d")
    spread = np.ptp(scene.points, axis=0)
    panel.set_box_aspect(np.maximum(spread, 1e-2 * spread.max()))
    for axis, name, part in zip(
        (panel.xaxis, panel.yaxis, panel.zaxis), "xyz", spread / spread.max(), strict=True
    ):
        axis.set_label_text(name + scene.length)
        axis.labelpad = 8
        axis.set_major_locator(MaxNLocator(max(1, round(6 * part))))
    faces = panel.plot_trisurf(*scene.points.T, triangles=scene.triangles, cmap="viridis")
    faces.set_array(scene.values[scene.triangles].mean(axis=1))
    faces.set_clim(*limits(scene.values))
    figure.colorbar(faces, ax=panel, location="bottom", label=scene.label, shrink=0.8)
    colours = limits(np.concatenate([v for v in scene.along if v is not None] or [np.zeros(1)]))
    dots = None
    for line, values in zip(scene.fronts, scene.along, strict=True):
        panel.plot(*line.T, color="red" if values is None else "0.3", linewidth=2)
        if values is not None:
            dots = panel.scatter(
                *line.T, c=values, cmap="plasma", vmin=colours[0], vmax=colours[1], s=12
            )
    if dots is not None:
        figure.colorbar(dots, ax=panel, location="right", label=scene.along_label, shrink=0.6)
    panel.set_title(scene.title)
    figure.savefig(path)
    plt.close(figure)


def draw_crack(
    run: Run,
    path: Path,
    time: float | None = None,
    field: str = "opening",
    quantity: str | None = None,
    renderer: str | None = None,
) -> list[str]:
    """The picture; what was drawn, a line."""
    scene = make_scene(run, time, field, quantity)
    renderer = choose_renderer(renderer)
    path.parent.mkdir(parents=True, exist_ok=True)
    (draw_with_pyvista if renderer == "pyvista" else draw_with_matplotlib)(scene, path)
    low, high = limits(scene.values)
    return [f"{path}: {scene.label} {low:.4g} to {high:.4g} ({renderer})"]
