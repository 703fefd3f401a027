"""From a file or a shape to a crack: repair, mesh, fronts, and everything that may be wrong."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from xmpm_prep.crack_body import BodyShape, read_body
from xmpm_prep.crack_front import (
    BOUNDARY,
    FRONT,
    OUTSIDE,
    Front,
    classify,
    extend,
    find_fronts,
    seen_as_front,
    tails,
)
from xmpm_prep.crack_intersect import check_intersection
from xmpm_prep.crack_mesh import MOST, mesh_surfaces
from xmpm_prep.crack_read import read_surface
from xmpm_prep.crack_remesh import remesh
from xmpm_prep.crack_shapes import Shape, build
from xmpm_prep.crack_surface import (
    Surface,
    check_manifold,
    orient,
    parts,
    remove_faulty_triangles,
)
from xmpm_prep.errors import PrepError, doubt, warn
from xmpm_prep.units import METRES

LEAST_ANGLE = 20.0  # of a triangle, where not asked for otherwise [degrees]
STRIP = 1.5  # width of the strip outside the body where not asked for otherwise [cells]


@dataclass(frozen=True)
class Wish:
    """What the user asks for."""

    source: object  # a path or a Shape
    size: float  # edge of the triangles [length]
    h: float  # edge of the grid's cells [length]
    name: str | None = None  # physical surface
    body: object = None  # path of a particle file or a model
    part: str | None = None  # body in that file
    unit: str | None = None  # of length
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # a node of the grid
    keep: bool = False  # take the triangles as they are
    turn: bool = False  # the plus side becomes the minus side
    strip: float | None = None  # width of the strips outside the body; 0 for none [length]
    angle: float = LEAST_ANGLE  # smallest one that is allowed [degrees]
    force: bool = False


@dataclass
class Crack:
    """A crack with what there is to report of it."""

    surface: Surface
    kind: np.ndarray  # classes of the free edges
    fronts: list[Front]
    unit: str
    has_body: bool
    notes: list[str] = field(default_factory=list)


def make_crack(wish: Wish) -> Crack:
    """Make a crack; what cannot be used raises PrepError."""
    if not (wish.size > 0 and wish.h > 0):
        raise PrepError("--size and --h must be positive numbers")
    surface, sized, own_body, notes = read_source(wish)
    body = find_body(wish, own_body)
    unit = choose_unit(wish, body)
    check_scale(wish, surface, body)
    surface = mesh(wish, surface, sized, notes)
    if wish.turn:
        surface = Surface(surface.points, surface.triangles[:, ::-1])
    inside = body.inside if body else None
    surface, kind = lengthen(wish, surface, body, notes)
    check_angle(wish, surface)
    if body and not crosses_body(surface, body):
        raise PrepError(
            f"the crack lies outside the body of {body.path}: the crack fills "
            f"{box(surface.points.min(0), surface.points.max(0))}, the body "
            f"{box(body.low, body.high)}"
        )
    fronts = find_fronts(surface, kind, inside)
    if body:
        seen = seen_as_front(surface, inside, wish.h, np.array(wish.origin, dtype=float))
        warn_of_seen(seen & (kind != FRONT) & ~tails(surface, fronts), notes)
    crack = Crack(surface, kind, fronts, unit, body is not None, notes)
    check_fronts(wish, crack)
    return crack


# --- steps ----------------------------------------------------------------------------------------


def read_source(wish: Wish):
    """The raw surface; whether it has the wanted size; the path of a body that comes with it."""
    if isinstance(wish.source, Shape):
        from xmpm_prep.gmsh_session import gmsh_session

        with gmsh_session() as gmsh:
            surface = mesh_surfaces(gmsh, build(gmsh, wish.source), wish.size, wish.angle)
        sized, own_body = True, None
    else:
        surface, sized, has_volume = read_surface(wish.source, wish.name, wish.size, wish.angle)
        own_body = wish.source if has_volume else None
    surface, notes = remove_faulty_triangles(surface)
    check_manifold(surface)
    surface, turned = orient(surface)
    if turned:
        notes.append(f"{turned} triangles were turned, so that all normals agree")
    check_intersection(surface)
    return surface, sized, own_body, notes


def find_body(wish: Wish, own_body) -> BodyShape | None:
    """The body that the user names, else the one in the crack's own file."""
    if wish.body is not None:
        return read_body(wish.body, wish.part, wish.h)
    return read_body(own_body, wish.part, wish.h) if own_body is not None else None


def choose_unit(wish: Wish, body: BodyShape | None) -> str:
    """The unit of length: asked for, or that of the body."""
    if body is not None and body.unit is not None:
        if wish.unit not in (None, body.unit):
            raise PrepError(
                f"mixed units: --unit is {wish.unit}, the body of {body.path} is in {body.unit}; "
                "nothing is converted"
            )
        return body.unit
    return wish.unit or "mm"


def check_scale(wish: Wish, surface: Surface, body: BodyShape | None) -> None:
    """Sizes that do not fit each other: most often a mistake of units."""
    extent = surface.extent
    if wish.size > extent:
        raise PrepError(
            f"triangles of size {wish.size:g} are larger than the whole crack, which is "
            f"{extent:.6g} long: mixed units?"
        )
    if (extent / wish.size) ** 2 > MOST:
        raise PrepError(
            f"triangles of size {wish.size:g} on a crack that is {extent:.6g} long would be too "
            "many: mixed units?"
        )
    if body is None:
        return
    ratio = extent / float((body.high - body.low).max())
    if ratio > 10.0 or ratio < 1e-3:
        hint = unit_hint(ratio)
        doubt(
            f"the crack is {ratio:.3g} times as long as the body of {body.path}: mixed "
            f"units?{hint}",
            wish.force,
        )


def unit_hint(ratio: float) -> str:
    """Which units would explain a ratio of lengths."""
    for crack, body in (("mm", "m"), ("m", "mm"), ("cm", "m"), ("m", "cm"), ("mm", "in")):
        mended = ratio * METRES[crack] / METRES[body]
        if 0.05 < mended < 1.5:
            return f" (a crack in {crack} and a body in {body} would explain it)"
    return ""


def mesh(wish: Wish, surface: Surface, sized: bool, notes: list[str]) -> Surface:
    """Triangles of the wanted size, unless they are to stay or have it already."""
    if sized or wish.keep:
        return surface
    before = len(surface.triangles)
    surface = remesh(surface, wish.size)
    check_manifold(surface)
    check_intersection(surface)
    notes.append(f"{before} triangles were meshed anew")
    return surface


def check_angle(wish: Wish, surface: Surface) -> None:
    """The smallest angle of a triangle must not be too small."""
    smallest = surface.angles.min(axis=1)
    worst = int(np.argmin(smallest))
    if smallest[worst] < wish.angle:
        centre = ", ".join(f"{value:.6g}" for value in surface.corners[worst].mean(axis=0))
        raise PrepError(
            f"the smallest angle is {smallest[worst]:.3g} degrees, at ({centre}); --min-angle asks "
            f"for {wish.angle:g}{': leave --keep away, or' if wish.keep else ':'} take another "
            "--size or a smaller angle"
        )


def lengthen(wish: Wish, surface: Surface, body: BodyShape | None, notes: list[str]):
    """Strips outside the body where the surface ends on or near its boundary."""
    inside = body.inside if body else None
    kind = classify(surface, inside, wish.h)
    strip = STRIP * wish.h if wish.strip is None else wish.strip
    short = kind == BOUNDARY
    if not short.any():
        return surface, kind
    if strip <= 0:
        notes.append(
            f"{short.sum()} edges end on the boundary of the body or less than half a cell "
            "outside; the program may take some of them for fronts"
        )
        return surface, kind
    surface = extend(surface, short, strip, wish.size)
    if surface.angles.min() < wish.angle and not wish.keep:
        surface = remesh(surface, wish.size)  # corners of strips may be sharp
    check_manifold(surface)
    check_intersection(surface)
    notes.append(f"a strip {strip:g} wide was added at {short.sum()} edges on the boundary")
    return surface, classify(surface, inside, wish.h)


def crosses_body(surface: Surface, body: BodyShape) -> bool:
    """Whether any part of the surface lies in the body."""
    near = ((surface.points >= body.low) & (surface.points <= body.high)).all(axis=1)
    if not near.any():
        return bool(body.inside(surface.corners.mean(axis=1)).any())
    if body.inside(surface.corners.mean(axis=1)).any():
        return True
    return bool(body.inside(surface.points[near]).any())


def warn_of_seen(wrong: np.ndarray, notes: list[str]) -> None:
    """Edges outside the body that the program would still take for fronts."""
    if wrong.any():
        warn(
            f"{wrong.sum()} edges outside the body have material in the cell ahead of them; the "
            "program will take them for fronts: let the crack reach further out of the body, or "
            "widen its --strip"
        )
        notes.append(f"{wrong.sum()} edges outside the body will be taken for fronts")


def check_fronts(wish: Wish, crack: Crack) -> None:
    """Fronts long enough for the grid."""
    for number, front in enumerate(crack.fronts, 1):
        if front.length < wish.h:
            place = crack.surface.points[front.vertices].mean(axis=0)
            doubt(
                f"front {number} at ({', '.join(f'{value:.6g}' for value in place)}) is "
                f"{front.length:.3g} long, shorter than a cell of {wish.h:g}",
                wish.force,
            )


def box(low: np.ndarray, high: np.ndarray) -> str:
    """A bounding box in words."""
    return " x ".join(f"{a:.6g}..{b:.6g}" for a, b in zip(low, high, strict=True))


# --- report ---------------------------------------------------------------------------------------


def report(wish: Wish, crack: Crack) -> list[str]:
    """What was made, in lines."""
    surface, unit = crack.surface, crack.unit
    length = surface.edge_lengths()
    count = parts(surface)
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    lines = [
        f"triangles   {len(surface.triangles)}, vertices {len(surface.points)}, "
        f"{count} {'part' if count == 1 else 'parts'}",
        f"area        {surface.areas.sum():.6g} {unit}^2 in {box(low, high)} {unit}",
        f"edges       {length.min():.4g} to {length.max():.4g} {unit}, mean {length.mean():.4g}, "
        f"asked {wish.size:g}",
        f"angles      {surface.angles.min():.1f} to {surface.angles.max():.1f} degrees",
    ]
    lines += [f"note        {text}" for text in crack.notes]
    if not crack.has_body:
        lines.append("body        none given: all free edges are taken for fronts")
    lines.append(
        f"free edges  {np.sum(crack.kind == FRONT)} front, {np.sum(crack.kind == BOUNDARY)} on the "
        f"boundary, {np.sum(crack.kind == OUTSIDE)} outside the body"
    )
    lines += [describe_front(i, front, crack) for i, front in enumerate(crack.fronts, 1)]
    if not crack.fronts:
        lines.append("fronts      none: the crack parts the body")
    return lines


def describe_front(number: int, front: Front, crack: Crack) -> str:
    """One front in words."""
    ends = crack.surface.points[front.vertices[[0, -1]]]
    where = "closed"
    if not front.closed:
        start, end = (", ".join(f"{value:.5g}" for value in point) for point in ends)
        where = f"from ({start}) to ({end})"
    return f"front {number}     {len(front.edges)} edges, {front.length:.6g} {crack.unit}, {where}"
