"""A scene as a PNG: by PyVista where VTK can draw without a screen, else by matplotlib."""

import subprocess
import sys

import numpy as np

SIZE = (1800, 900)  # pixels
# VTK without EGL or OSMesa does not fail, it crashes: so it is tried in a child process.
PROBE = """
import pyvista, sys
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
image = plotter.screenshot(return_img=True)
sys.exit(0 if image is not None and image.std() > 1 else 1)
"""
VIEWS = (np.array([1.0, -1.6, 1.1]), np.array([-1.3, 1.2, -0.8]))  # from the middle to the eye
MOST_DRAWN = 20_000  # triangles of an item that matplotlib draws


def can_render():
    """Whether VTK can draw without a screen here, found out where a crash does no harm."""
    try:
        probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return False
    return probe.returncode == 0


def draw(scene, path, renderer=None):
    """Draw by the renderer that is named or that works; its name."""
    renderer = renderer or ("pyvista" if can_render() else "matplotlib")
    (draw_with_pyvista if renderer == "pyvista" else draw_with_matplotlib)(scene, path)
    return renderer


def panels(scene):
    """Title, opacity of bodies, and direction to the eye of both panels."""
    if scene.of_kind("crack") and scene.of_kind("body", "set"):
        return (("bodies, sets and grid", 1.0, VIEWS[0]), ("cracks and fronts", 0.15, VIEWS[0]))
    return (("", 1.0, VIEWS[0]), ("from the other side", 1.0, VIEWS[1]))


def widths(kind):
    """Width of lines of a kind, in pixels."""
    return {"front": 5.0, "edges": 1.0, "grid": 1.0}[kind]


def draw_with_pyvista(scene, path):
    """Draw with VTK off the screen."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # it warns that there is no screen
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=SIZE, border=False)
    plotter.set_background("white")
    for column, (title, opacity, view) in enumerate(panels(scene)):
        plotter.subplot(0, column)
        for item in sorted(scene.items, key=lambda item: item.kind in ("body", "set")):
            flat = np.column_stack([np.full(len(item.cells), item.cells.shape[1]), item.cells])
            if item.cells.shape[1] == 2:
                mesh = pyvista.PolyData(item.points, lines=flat.ravel())
                plotter.add_mesh(mesh, color=item.colour, line_width=widths(item.kind))
            else:
                mesh = pyvista.PolyData(item.points, flat.ravel())
                shown = opacity if item.kind in ("body", "set") else 1.0
                plotter.add_mesh(mesh, color=item.colour, opacity=shown, ambient=0.25)
        plotter.add_text(title, position="upper_edge", font_size=12, color="black")
        _look(plotter, scene, view)
        plotter.add_axes(color="black")
    plotter.subplot(0, 0)
    entries = [[name, colour] for name, colour in legend(scene)]
    if entries:
        plotter.add_legend(
            entries,
            bcolor=None,
            face="rectangle",
            loc="upper left",
            size=(0.05 + 0.018 * max(len(name) for name, _ in entries), 0.03 * len(entries)),
        )
    plotter.screenshot(path)
    plotter.close()


def legend(scene):
    """Names and colours, each once."""
    shown = {item.name: item.colour for item in scene.items if item.kind != "edges"}
    return list(shown.items())[:14]


def _look(plotter, scene, view):
    """A parallel camera on everything."""
    every = np.concatenate([item.points for item in scene.items])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(every, axis=0))) or 1.0
    view = view / np.linalg.norm(view)
    plotter.camera_position = [middle + 2 * size * view, middle, (0, 0, 1)]
    plotter.enable_parallel_projection()
    across = np.cross((0, 0, 1), view)
    across /= np.linalg.norm(across)
    width, height = np.ptp((every - middle) @ np.array([across, np.cross(view, across)]).T, axis=0)
    aspect = SIZE[0] / 2 / SIZE[1]
    plotter.camera.parallel_scale = 0.5 * max(width / aspect, height / 0.85) * 1.1
    plotter.reset_camera_clipping_range()


def draw_with_matplotlib(scene, path):
    """Draw without VTK: far slower, so that of many triangles some are left out."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    figure = plt.figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100, layout="constrained")
    low, high = scene.bounds()
    for column, (title, opacity, view) in enumerate(panels(scene)):
        axes = figure.add_subplot(1, 2, column + 1, projection="3d")
        for item in scene.items:
            some = item.cells[:: 1 + len(item.cells) // MOST_DRAWN]
            if item.cells.shape[1] == 2:
                drawn = Line3DCollection(item.points[some], linewidths=widths(item.kind) / 2)
                drawn.set_color(item.colour)
            else:
                shown = opacity if item.kind in ("body", "set") else 1.0
                drawn = Poly3DCollection(
                    item.points[some], facecolors=item.colour, alpha=shown, shade=True
                )
            axes.add_collection3d(drawn)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        axes.set(xlabel="x", ylabel="y", zlabel="z", title=title)
        axes.set_box_aspect(np.maximum(high - low, 0.02 * np.max(high - low)))
        flat = float(np.hypot(view[0], view[1]))
        axes.view_init(
            elev=float(np.degrees(np.arctan2(view[2], flat))),
            azim=float(np.degrees(np.arctan2(view[1], view[0]))),
        )
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for _, colour in legend(scene)]
    figure.legend(handles, [name for name, _ in legend(scene)], loc="lower center", ncols=4)
    figure.savefig(path)
    plt.close(figure)
