"""Analytic crack surfaces, built in the OpenCASCADE kernel of an open gmsh session."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from xmpm_prep.errors import PrepError


@dataclass(frozen=True)
class Shape:
    """An analytic surface: its kind, its frame and its sizes, as in the deck's *CRACK."""

    kind: str  # disc, ellipse, sector, plane, cylinder or cone
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    along: tuple[float, float, float] = (1.0, 0.0, 0.0)  # angle 0; the width; first semi-axis
    across: tuple[float, float, float] = (0.0, 1.0, 0.0)  # the depth; second semi-axis
    radius: tuple[float, ...] = ()  # of a disc, sector, cylinder; of a cone two: bottom, top
    semi_axes: tuple[float, ...] = ()  # of an ellipse or a sector of one
    width: float = 0.0  # of a plane, along
    depth: float = 0.0  # of a plane, across
    height: float = 0.0  # of a cylinder or cone, along x across, upwards from the centre
    angles: tuple[float, float] = (0.0, 360.0)  # from along towards across [degrees]


def frame(shape: Shape) -> np.ndarray:
    """Unit vectors along, across and along x across, in rows."""
    along, across = np.array(shape.along, float), np.array(shape.across, float)
    size = np.linalg.norm(along) * np.linalg.norm(across)
    if not np.isfinite(size) or size == 0.0:
        raise PrepError(f"{shape.kind}: along and across must be directions, not zero vectors")
    cosine = along @ across / size
    if abs(cosine) > 1e-6:
        raise PrepError(
            f"{shape.kind}: along and across must be at right angles; they enclose "
            f"{np.degrees(np.arccos(np.clip(cosine, -1, 1))):.6g} degrees"
        )
    along = along / np.linalg.norm(along)
    across = across - (across @ along) * along
    across /= np.linalg.norm(across)
    return np.array([along, across, np.cross(along, across)])


def build(gmsh: Any, shape: Shape) -> list[int]:
    """Tags of the surfaces of a shape, made in gmsh's current model."""
    check(shape)
    make = {
        "disc": make_ellipse,
        "ellipse": make_ellipse,
        "sector": make_sector,
        "plane": make_plane,
        "cylinder": make_turned,
        "cone": make_turned,
    }
    tags = make[shape.kind](gmsh.model.occ, shape)
    axes = frame(shape)
    matrix = np.eye(4)
    matrix[:3, :3] = axes.T
    matrix[:3, 3] = shape.centre
    gmsh.model.occ.affineTransform([(2, tag) for tag in tags], matrix.ravel().tolist())
    gmsh.model.occ.synchronize()
    return tags


def check(shape: Shape) -> None:
    """The sizes that the kind needs must be there and positive."""
    radii = {"disc": (1,), "sector": (0, 1), "cylinder": (1,), "cone": (2,)}.get(shape.kind, (0,))
    if len(shape.radius) not in radii:
        numbers = "two radii (bottom, top)" if radii == (2,) else "one radius"
        raise PrepError(f"{shape.kind}: it needs {numbers}")
    if shape.kind == "ellipse" or (shape.kind == "sector" and not shape.radius):
        require(shape, "two semi-axes", shape.semi_axes, 2)
    elif shape.kind == "plane":
        require(shape, "a width and a depth", (shape.width, shape.depth), 2)
    elif shape.kind == "cone":
        require(shape, "a height", (shape.height,), 1)
        if min(shape.radius) < 0 or max(shape.radius) <= 0 or shape.radius[0] == shape.radius[1]:
            raise PrepError("cone: its radii must be two different numbers, not negative")
    else:
        require(shape, "a radius", shape.radius, 1)
        if shape.kind == "cylinder":
            require(shape, "a height", (shape.height,), 1)
    turn = shape.angles[1] - shape.angles[0]
    if not 0 < turn <= 360:
        raise PrepError(
            f"{shape.kind}: angles {shape.angles[0]:g} to {shape.angles[1]:g}; the second must be "
            "larger, by 360 degrees at most"
        )
    if shape.kind in ("disc", "ellipse", "plane") and turn < 360:
        raise PrepError(f"{shape.kind}: part of a disc or an ellipse is a sector")


def require(shape: Shape, what: str, values: tuple[float, ...], count: int) -> None:
    """These many positive numbers."""
    good = len(values) == count and all(np.isfinite(v) and v > 0 for v in values)
    if not good:
        raise PrepError(f"{shape.kind}: it needs {what}, positive")


def semi_axes(shape: Shape) -> tuple[float, float]:
    """Those of an ellipse; twice the radius of a disc."""
    return (shape.radius[0], shape.radius[0]) if shape.radius else shape.semi_axes[:2]


def make_ellipse(occ: Any, shape: Shape) -> list[int]:
    """A whole disc or ellipse in the plane z = 0."""
    return [occ.addPlaneSurface([occ.addCurveLoop(arcs(occ, shape, 0.0, 2.0 * np.pi)[0])])]


def make_sector(occ: Any, shape: Shape) -> list[int]:
    """The part of a disc or ellipse between two angles at its centre."""
    turns = np.radians(shape.angles)
    if shape.angles[1] - shape.angles[0] >= 360.0:
        return make_ellipse(occ, shape)
    a, b = semi_axes(shape)
    # The parameter of the ellipse under an angle, continuous over any number of turns.
    whole = 2.0 * np.pi * np.round(turns / (2.0 * np.pi))
    start, end = whole + np.arctan2(a * np.sin(turns - whole), b * np.cos(turns - whole))
    rim, points = arcs(occ, shape, start, end)
    centre = occ.addPoint(0, 0, 0)
    straight = [occ.addLine(centre, points[0]), occ.addLine(points[-1], centre)]
    return [occ.addPlaneSurface([occ.addCurveLoop([straight[0], *rim, straight[1]])])]


def arcs(occ: Any, shape: Shape, start: float, end: float) -> tuple[list[int], list[int]]:
    """Arcs of an ellipse in quarters at most, and their end points."""
    a, b = semi_axes(shape)
    pieces = max(2, int(np.ceil((end - start) / (0.5 * np.pi) - 1e-9)))
    parameters = np.linspace(start, end, pieces + 1)
    closed = end - start >= 2.0 * np.pi - 1e-12
    points = [
        occ.addPoint(a * np.cos(t), b * np.sin(t), 0)
        for t in (parameters[:-1] if closed else parameters)
    ]
    if closed:
        points.append(points[0])
    centre = occ.addPoint(0, 0, 0)
    major = occ.addPoint(a, 0, 0) if a >= b else occ.addPoint(0, b, 0)
    curves = []
    for first, last in pairwise(points):
        if a == b:
            curves.append(occ.addCircleArc(first, centre, last))
        else:
            curves.append(occ.addEllipseArc(first, centre, major, last))
    return curves, points


def make_plane(occ: Any, shape: Shape) -> list[int]:
    """A rectangle about the origin."""
    return [occ.addRectangle(-shape.width / 2, -shape.depth / 2, 0, shape.width, shape.depth)]


def make_turned(occ: Any, shape: Shape) -> list[int]:
    """A line from bottom to top, turned about z in steps of a third of a turn at most."""
    start, end = np.radians(shape.angles)
    bottom, top = shape.radius[0], shape.radius[-1]
    pieces = max(1, int(np.ceil((end - start) / (2.0 * np.pi / 3.0) - 1e-9)))
    ends = [
        occ.addPoint(radius * np.cos(start), radius * np.sin(start), height)
        for radius, height in ((bottom, 0.0), (top, shape.height))
    ]
    line = (1, occ.addLine(*ends))
    tags = []
    for _ in range(pieces):
        made = occ.revolve([line], 0, 0, 0, 0, 0, 1, (end - start) / pieces)
        tags += [tag for dimension, tag in made if dimension == 2]
        line = next(item for item in made if item[0] == 1)
    if pieces > 1:
        made, _ = occ.fragment([(2, tags[0])], [(2, tag) for tag in tags[1:]])
        tags = [tag for dimension, tag in made if dimension == 2]
    return tags
