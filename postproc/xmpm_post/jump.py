"""`xmpm-post jump`: the displacement jump across the cracks.

Left: a section through the body along the cracks, coloured by displacement, deformed so that the
openings show. Right: the crack surfaces coloured by the jump u+ - u-, with their fronts.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from xmpm_post.errors import PostError
from xmpm_post.render import (
    BAR,
    choose_renderer,
    faces_of,
    limits,
    look,
    quiet_vtk,
    surface_of,
    vertex_normals,
)
from xmpm_post.run import Run
from xmpm_post.vtkhdf import PolyData

SIZE = (1600, 700)  # pixels
COLOURS = {"section": "coolwarm", "jump": "viridis"}


@dataclass
class Scene:
    """What is drawn."""

    points: np.ndarray  # (n,3) particles of the section, deformed
    values: np.ndarray  # (n,) displacement that colours them
    spacing: float  # of the particles
    surface: np.ndarray  # (m,3) vertices of the cracks
    triangles: np.ndarray  # (k,3) vertices of the triangles
    fronts: list  # vertex numbers of each front
    jump: np.ndarray  # (m,) magnitude of the jump at the vertices
    view: np.ndarray  # (3,) from the section towards the eye
    normal: np.ndarray  # (3,) mean normal of the cracks
    title: str  # above the section
    label: str  # of the section's colours
    jump_label: str  # of the cracks' colours


def jump_of(crack: PolyData, normals, points, displacement, spacing) -> np.ndarray:
    """Jump u+ - u- at the vertices: the crack's own field, or that of the nearest particles."""
    if "opening" in crack.fields:
        return crack.fields["opening"]
    surface = crack.points
    tree = cKDTree(points)
    jump = np.zeros_like(surface)
    for i, near in enumerate(tree.query_ball_point(surface, 3 * spacing)):
        near = np.asarray(near, int)
        height = (points[near] - surface[i]) @ normals[i]
        above, below = near[height > 0], near[height <= 0]
        if len(above) and len(below):
            jump[i] = displacement[above].mean(axis=0) - displacement[below].mean(axis=0)
    return jump


def choose_view(areas, points):
    """Axis along which the cracks look like lines; of two such the one where the body is thin."""
    weights = (areas**2 / np.linalg.norm(areas, axis=1, keepdims=True)).sum(axis=0)
    extent = np.ptp(points, axis=0)
    score = weights / weights.sum() + 0.1 * extent / extent.max()
    return np.eye(3)[np.argmin(score)]


def make_scene(
    particles: PolyData, crack: PolyData, scale: float | None = None, time_unit: str = ""
) -> Scene:
    """Everything that is drawn, from the two data sets."""
    points, surface, triangles = particles.points, crack.points, surface_of(crack).triangles
    if "displacement" not in particles.fields:
        raise PostError(
            f"{particles.source}: no field displacement; name it under *OUTPUT particles ="
        )
    displacement = particles.fields["displacement"]
    normals, areas = vertex_normals(surface, triangles)
    spacing = float(np.median(cKDTree(points).query(points, k=2)[0][:, 1]))
    jump = jump_of(crack, normals, points, displacement, spacing)

    view = choose_view(areas, points)
    normal = areas.sum(axis=0)
    parallel = np.linalg.norm(normal) > 0.9 * np.linalg.norm(areas, axis=1).sum()
    normal /= max(np.linalg.norm(normal), np.finfo(float).tiny)
    size = np.linalg.norm(jump, axis=1)
    unit = particles.units.get("displacement", "")
    unit = f" [{unit}]" if unit else ""
    if scale is None:  # the widest opening becomes 4 % of the body
        scale = 0.04 * np.ptp(points, axis=0).max() / max(size.max(), np.finfo(float).tiny)
    # A thin section through the middle of the cracks, so that a crack inside the body shows.
    middle = surface[np.unique(triangles)].mean(axis=0)
    depth = (points - middle) @ view
    kept = np.abs(depth) <= max(1.5 * spacing, np.abs(depth).min())
    return Scene(
        points=points[kept] + (scale - 1) * displacement[kept],
        values=displacement[kept] @ normal
        if parallel
        else np.linalg.norm(displacement[kept], axis=1),
        spacing=spacing,
        surface=surface,
        triangles=triangles,
        fronts=crack.lines,
        jump=size,
        view=view,
        normal=normal,
        title=f"t = {particles.time:.6g} {time_unit}".rstrip() + f", displacements x {scale:.3g}",
        label=("displacement along the cracks' normal" if parallel else "displacement") + unit,
        jump_label="jump of displacement" + unit,
    )


def up_for(view):
    """Direction that stands upright in the picture of the section."""
    return np.array([0.0, 1.0, 0.0]) if abs(view[1]) < 0.5 else np.array([0.0, 0.0, 1.0])


def draw_with_pyvista(scene, path):
    """Draw with VTK off the screen."""
    import pyvista

    quiet_vtk()
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=SIZE, border=False)
    plotter.set_background("white")

    plotter.subplot(0, 0)
    # A cube a particle, wide enough to hide the gaps that magnified strains open.
    cloud = pyvista.PolyData(scene.points)
    cloud["u"] = scene.values
    cubes = cloud.glyph(geom=pyvista.Cube(), scale=False, orient=False, factor=1.3 * scene.spacing)
    plotter.add_mesh(
        cubes,
        scalars="u",
        cmap=COLOURS["section"],
        clim=limits(scene.values),
        lighting=False,
        scalar_bar_args=BAR | {"title": scene.label + "\n"},
    )
    plotter.add_text(scene.title, position="upper_edge", font_size=11, color="black")
    look(plotter, scene.points, scene.view, up_for(scene.view), SIZE[0] / 2 / SIZE[1])

    plotter.subplot(0, 1)
    mesh = pyvista.PolyData(scene.surface, faces_of(scene.triangles))
    mesh["jump"] = scene.jump
    plotter.add_mesh(
        mesh,
        scalars="jump",
        cmap=COLOURS["jump"],
        clim=limits(scene.jump),
        lighting=False,
        show_edges=len(scene.triangles) < 5000,
        edge_opacity=0.2,
        scalar_bar_args=BAR | {"title": scene.jump_label + "\n"},
    )
    for front in scene.fronts:
        plotter.add_lines(scene.surface[front], color="red", width=4, connected=True)
    plotter.add_text("cracks and fronts", position="upper_edge", font_size=11, color="black")
    tilted = scene.normal + 0.35 * scene.view + 0.25 * np.cross(scene.normal, scene.view)
    up = scene.view - (scene.view @ scene.normal) * scene.normal
    look(plotter, scene.surface, tilted, up, SIZE[0] / 2 / SIZE[1])
    plotter.screenshot(path)
    plotter.close()


def draw_with_matplotlib(scene, path):
    """Draw without VTK's rendering."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100, layout="constrained")
    section = figure.add_subplot(1, 2, 1)
    across = np.cross(up_for(scene.view), scene.view)
    upright = np.cross(scene.view, across)
    order = np.argsort(scene.points @ scene.view)  # the nearest last
    x, y = scene.points[order] @ across, scene.points[order] @ upright
    # Size of a marker in points**2: the panel is 7 inches wide; a little more hides the gaps.
    size = (9 * 72 * scene.spacing / max(np.ptp(x), np.ptp(y), scene.spacing)) ** 2
    colours = scene.values[order]
    dots = section.scatter(
        x, y, s=size, c=colours, cmap=COLOURS["section"], marker="s", linewidths=0
    )
    section.set(aspect="equal", title=scene.title)
    figure.colorbar(dots, ax=section, location="bottom", label=scene.label, shrink=0.8)

    panel = figure.add_subplot(1, 2, 2, projection="3d")
    panel.set_box_aspect(np.maximum(np.ptp(scene.surface, axis=0), 1e-3 * np.ptp(scene.surface)))
    faces = panel.plot_trisurf(*scene.surface.T, triangles=scene.triangles, cmap=COLOURS["jump"])
    faces.set_array(scene.jump[scene.triangles].mean(axis=1))
    faces.set_clim(*limits(scene.jump))
    for front in scene.fronts:
        panel.plot(*scene.surface[front].T, color="red", linewidth=2)
    panel.set_title("cracks and fronts")
    figure.colorbar(faces, ax=panel, location="bottom", label=scene.jump_label, shrink=0.8)
    figure.savefig(path)
    plt.close(figure)


def draw_jump(
    run: Run,
    path: Path,
    time: float | None = None,
    scale: float | None = None,
    renderer: str | None = None,
) -> list[str]:
    """The picture; what was drawn, a line."""
    particles = run.particles(time)
    crack = run.crack(particles.time)
    scene = make_scene(particles, crack, scale, run.units[1])
    renderer = choose_renderer(renderer)
    path.parent.mkdir(parents=True, exist_ok=True)
    (draw_with_pyvista if renderer == "pyvista" else draw_with_matplotlib)(scene, path)
    return [f"{path}: jump up to {scene.jump.max():.6g} at t = {particles.time:.6g} ({renderer})"]
