#!/usr/bin/env python3
"""Picture of the displacement jump across the cracks of a run.

    python3 postproc/jump_picture.py NAME_particles.vtkhdf NAME_crack.vtkhdf -o jump.png

Left: a section through the body along the cracks, coloured by displacement, deformed so that the
openings show. Right: the crack surfaces coloured by the jump u+ - u-, with their fronts. PyVista
draws where VTK can render without a screen, which is tried in a child process because VTK without
EGL or OSMesa does not fail, it crashes; otherwise matplotlib draws.
"""

import argparse
import subprocess
import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

PROBE = """
import pyvista, sys
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
image = plotter.screenshot(return_img=True)
sys.exit(0 if image is not None and image.std() > 1 else 1)
"""
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


def read_step(path, time=None):
    """Poly data of a time (the last one by default) and that time."""
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    times = information.Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    if times:
        time = min(times, key=lambda t: abs(t - time)) if time is not None else times[-1]
        reader.UpdateTimeStep(time)
    else:
        reader.Update()
    data = reader.GetOutputDataObject(0)
    if data is None or data.GetNumberOfPoints() == 0:
        sys.exit(f"{path}: no points at this time")
    return data, time


def field(data, name):
    """Values of a point field, or None."""
    array = data.GetPointData().GetArray(name)
    return None if array is None else vtk_to_numpy(array).astype(float)


def cells(cell_array):
    """Point numbers of each cell."""
    if cell_array.GetNumberOfCells() == 0:
        return []
    ids = vtk_to_numpy(cell_array.GetConnectivityArray())
    offsets = vtk_to_numpy(cell_array.GetOffsetsArray())
    return [ids[first:last] for first, last in pairwise(offsets)]


def vertex_normals(points, triangles):
    """Area-weighted normals at the vertices (unit), and those of the triangles times their area."""
    corners = points[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    normals = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(normals, corner, areas)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1), areas


def jump_of(data, surface, normals, points, displacement, spacing):
    """Jump u+ - u- at the vertices: the crack's own field, or that of the nearest particles."""
    own = field(data, "opening")
    if own is not None and own.ndim == 2:
        return own
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


def make_scene(particles, crack, time, scale):
    """Everything that is drawn, from the two data sets."""
    points = vtk_to_numpy(particles.GetPoints().GetData()).astype(float)
    displacement = field(particles, "displacement")
    if displacement is None:
        sys.exit("the particles have no field `displacement`: name it under *OUTPUT particles =")
    surface = vtk_to_numpy(crack.GetPoints().GetData()).astype(float)
    triangles = np.array(cells(crack.GetPolys()), int).reshape(-1, 3)
    if len(triangles) == 0:
        sys.exit("the crack file holds no triangles")
    normals, areas = vertex_normals(surface, triangles)
    spacing = float(np.median(cKDTree(points).query(points, k=2)[0][:, 1]))
    jump = jump_of(crack, surface, normals, points, displacement, spacing)

    view = choose_view(areas, points)
    normal = areas.sum(axis=0)
    parallel = np.linalg.norm(normal) > 0.9 * np.linalg.norm(areas, axis=1).sum()
    normal /= max(np.linalg.norm(normal), np.finfo(float).tiny)
    size = np.linalg.norm(jump, axis=1)
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
        fronts=cells(crack.GetLines()),
        jump=size,
        view=view,
        normal=normal,
        title=f"t = {time:.6g}, displacements x {scale:.3g}",
        label="displacement along the cracks' normal" if parallel else "displacement",
    )


def up_for(view):
    """Direction that stands upright in the picture of the section."""
    return np.array([0.0, 1.0, 0.0]) if abs(view[1]) < 0.5 else np.array([0.0, 0.0, 1.0])


def can_render():
    """Whether VTK can draw without a screen here, found out where a crash does no harm."""
    try:
        probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return False
    return probe.returncode == 0


def limits(values):
    """Range of the colours, never empty."""
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def draw_with_pyvista(scene, path):
    """Draw with VTK off the screen."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # it warns that there is no screen
    bar = {"n_labels": 4, "fmt": "%.3g", "color": "black", "width": 0.7, "position_x": 0.15}
    bar |= {"position_y": 0.03, "height": 0.1, "title_font_size": 22, "label_font_size": 18}
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
        scalar_bar_args=bar | {"title": scene.label + "\n"},
    )
    plotter.add_text(scene.title, position="upper_edge", font_size=11, color="black")
    look(plotter, scene.points, scene.view, up_for(scene.view))

    plotter.subplot(0, 1)
    faces = np.column_stack([np.full(len(scene.triangles), 3), scene.triangles]).ravel()
    mesh = pyvista.PolyData(scene.surface, faces)
    mesh["jump"] = scene.jump
    plotter.add_mesh(
        mesh,
        scalars="jump",
        cmap=COLOURS["jump"],
        clim=limits(scene.jump),
        lighting=False,
        show_edges=len(scene.triangles) < 5000,
        edge_opacity=0.2,
        scalar_bar_args=bar | {"title": "jump of displacement\n"},
    )
    for front in scene.fronts:
        plotter.add_lines(scene.surface[front], color="red", width=4, connected=True)
    plotter.add_text("cracks and fronts", position="upper_edge", font_size=11, color="black")
    tilted = scene.normal + 0.35 * scene.view + 0.25 * np.cross(scene.normal, scene.view)
    up = scene.view - (scene.view @ scene.normal) * scene.normal
    look(plotter, scene.surface, tilted, up)
    plotter.screenshot(path)
    plotter.close()


def look(plotter, points, view, up):
    """Point a parallel camera of the active panel at all points."""
    view = view / np.linalg.norm(view)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    size = np.linalg.norm(np.ptp(points, axis=0))
    plotter.camera_position = [middle + 2 * size * view, middle, up]
    plotter.enable_parallel_projection()
    across = np.cross(up, view)
    across /= np.linalg.norm(across)
    upright = np.cross(view, across)
    width, height = np.ptp((points - middle) @ np.array([across, upright]).T, axis=0)
    aspect = SIZE[0] / 2 / SIZE[1]
    plotter.camera.parallel_scale = 0.5 * max(width / aspect, height / 0.7) * 1.08
    plotter.reset_camera_clipping_range()


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
    figure.colorbar(faces, ax=panel, location="bottom", label="jump of displacement", shrink=0.8)
    figure.savefig(path)
    plt.close(figure)


def main(arguments=None):
    """Read, draw, say what was drawn."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("particles", type=Path, help="NAME_particles.vtkhdf")
    parser.add_argument("crack", type=Path, help="NAME_crack.vtkhdf")
    parser.add_argument("-o", "--output", type=Path, required=True, help="PNG to write")
    parser.add_argument("--time", type=float, help="the step nearest to this time (default: last)")
    parser.add_argument("--scale", type=float, help="magnification of the displacements")
    parser.add_argument("--renderer", choices=["pyvista", "matplotlib"], help="default: by trial")
    options = parser.parse_args(arguments)
    for path in (options.particles, options.crack):
        if not path.is_file():
            sys.exit(f"{path}: no such file")

    particles, time = read_step(options.particles, options.time)
    crack, _ = read_step(options.crack, time)
    scene = make_scene(particles, crack, time or 0.0, options.scale)
    renderer = options.renderer or ("pyvista" if can_render() else "matplotlib")
    options.output.parent.mkdir(parents=True, exist_ok=True)
    (draw_with_pyvista if renderer == "pyvista" else draw_with_matplotlib)(scene, options.output)
    print(
        f"{options.output}: jump up to {scene.jump.max():.6g} at t = {time or 0:.6g} ({renderer})"
    )


if __name__ == "__main__":
    main()
