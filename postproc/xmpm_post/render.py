"""Drawing in three dimensions: PyVista where VTK can render without a screen, else matplotlib."""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from xmpm_post.errors import PostError
from xmpm_post.vtkhdf import PolyData

# VTK without EGL or OSMesa does not fail, it crashes: so it is tried in a child process.
PROBE = """
import pyvista, sys
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
image = plotter.screenshot(return_img=True)
sys.exit(0 if image is not None and image.std() > 1 else 1)
"""
RENDERERS = ("pyvista", "matplotlib")
BAR = {
    "n_labels": 4,
    "fmt": "%.3g",
    "color": "black",
    "width": 0.7,
    "position_x": 0.15,
    "position_y": 0.03,
    "height": 0.1,
    "title_font_size": 22,
    "label_font_size": 18,
}


def can_render() -> bool:
    """Whether VTK can draw without a screen here, found out where a crash does no harm."""
    try:
        probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return False
    return probe.returncode == 0


def choose_renderer(wanted: str | None) -> str:
    """The renderer that was asked for, or the best that works."""
    return wanted or ("pyvista" if can_render() else "matplotlib")


def surface_of(crack: PolyData) -> PolyData:
    """The same data, which must hold triangles."""
    if len(crack.triangles) == 0:
        raise PostError(f"{crack.source}: no triangles of a crack in it")
    return crack


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Area-weighted normals at the vertices (unit), and those of the triangles times their area."""
    corners = points[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    normals = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(normals, corner, areas)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1), areas


def limits(values: np.ndarray) -> tuple[float, float]:
    """Range of the colours, never empty."""
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return -0.5, 0.5
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def quiet_vtk() -> None:
    """Keep VTK from warning that there is no screen."""
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)


def faces_of(triangles: np.ndarray) -> np.ndarray:
    """Triangles as PyVista wants them."""
    return np.column_stack([np.full(len(triangles), 3), triangles]).ravel()


def look(plotter, points: np.ndarray, view: np.ndarray, up: np.ndarray, aspect: float) -> None:
    """Point a parallel camera of the active panel at all points; aspect is width over height."""
    view = view / np.linalg.norm(view)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    size = np.linalg.norm(np.ptp(points, axis=0))
    plotter.camera_position = [middle + 2 * size * view, middle, up]
    plotter.enable_parallel_projection()
    across = np.cross(up, view)
    across /= np.linalg.norm(across)
    upright = np.cross(view, across)
    width, height = np.ptp((points - middle) @ np.array([across, upright]).T, axis=0)
    plotter.camera.parallel_scale = 0.5 * max(width / aspect, height / 0.7) * 1.08
    plotter.reset_camera_clipping_range()


def tilted_view(areas: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Direction to the eye, half from above the surface, and what stands upright then."""
    normal = areas.sum(axis=0)
    if np.linalg.norm(normal) < 1e-6 * np.linalg.norm(areas, axis=1).sum():
        normal = areas[0]
    normal = normal / np.linalg.norm(normal)
    spread = np.ptp(points, axis=0)
    side = np.eye(3)[np.argmin(np.abs(normal) + 0.01 * spread / max(spread.max(), 1e-300))]
    side = side - (side @ normal) * normal
    side /= np.linalg.norm(side)
    return normal + 0.6 * side + 0.35 * np.cross(normal, side), -side + 0.2 * normal
