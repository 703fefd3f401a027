"""Make a crack file out of a surface.

SURFACE is a file: geometry or a mesh of gmsh (.geo, .step, .brep, .iges, .msh), STL, OFF, VTK
(.vtk, .vtu, .vtp), PLY, OBJ or a crack file; or a shape: disc, ellipse, sector, plane, cylinder,
cone. Shapes have the keys of the deck's *CRACK; the axis of a cylinder or cone is along x across,
and its centre the middle of its bottom.

The body (--body, or the volumes in the file of the crack) tells fronts from edges on or outside its
boundary. Where the surface ends on the boundary, a strip is added that goes on outside.

    xmpm-prep crack disc --radius 10 --size 1 --unit mm -o penny.h5
    xmpm-prep crack part.geo --name flaw --size 1 --h 2 --unit mm -o flaw.h5
    xmpm-prep crack scan.stl --body body.h5 --size 1 --h 2 -o scan.h5
"""

from xmpm_prep.units import METRES

HELP = "make a crack file: check a surface, find its fronts, mesh it to a size"
SHAPES = ("disc", "ellipse", "sector", "plane", "cylinder", "cone")


def add_arguments(parser):
    """Options of the command."""
    add = parser.add_argument
    add("surface", metavar="SURFACE", help="a file, or a shape: " + ", ".join(SHAPES))
    add("--size", type=float, required=True, help="edge of the triangles")
    add("-o", "--output", metavar="FILE", required=True, help="the crack file (.h5)")
    add("--h", type=float, help="edge of the grid's cells (default: as --size)")
    add(
        "--origin",
        type=float,
        nargs=3,
        default=(0.0, 0.0, 0.0),
        metavar=("X", "Y", "Z"),
        help="a node of the grid (default 0 0 0)",
    )
    add("--unit", choices=METRES, help="unit of length (default: that of the body, else mm)")
    add("--name", help="physical surface to take from a file of gmsh")
    add("--body", metavar="FILE", help="particle file, geometry, mesh or closed STL of the body")
    add("--part", metavar="NAME", help="which body of that file")
    add("--keep", action="store_true", help="take the triangles of the file as they are")
    add("--turn", action="store_true", help="exchange the plus and the minus side")
    add("--strip", type=float, help="width of the strip outside the body, 0 for none (1.5 cells)")
    add("--min-angle", type=float, default=20.0, help="smallest angle of a triangle [degrees]")
    add("--force", action="store_true", help="go on where something is probably a mistake")
    shape = parser.add_argument_group("shapes")
    for name, axes in (("centre", (0, 0, 0)), ("along", (1, 0, 0)), ("across", (0, 1, 0))):
        shape.add_argument(f"--{name}", type=float, nargs=3, default=axes, metavar=("X", "Y", "Z"))
    shape.add_argument(
        "--radius", type=float, nargs="+", default=(), help="of a cone two: bottom and top"
    )
    shape.add_argument("--semi-axes", type=float, nargs=2, default=(), metavar=("A", "B"))
    shape.add_argument("--width", type=float, default=0.0, help="of a plane, along")
    shape.add_argument("--depth", type=float, default=0.0, help="of a plane, across")
    shape.add_argument("--height", type=float, default=0.0, help="of a cylinder or cone")
    shape.add_argument(
        "--angles",
        type=float,
        nargs=2,
        default=(0.0, 360.0),
        metavar=("FROM", "TO"),
        help="from along towards across [degrees]",
    )


def run(options):
    """Make the crack, write it, say what it is."""
    from xmpm_prep.crack_file import write_crack
    from xmpm_prep.crack_make import Wish, make_crack, report
    from xmpm_prep.crack_shapes import Shape
    from xmpm_prep.errors import PrepError

    if not options.output.endswith(".h5"):
        raise PrepError(f"-o {options.output}: the name of a crack file ends in .h5")
    source = options.surface
    if source in SHAPES:
        source = Shape(
            source,
            tuple(options.centre),
            tuple(options.along),
            tuple(options.across),
            tuple(options.radius),
            tuple(options.semi_axes),
            options.width,
            options.depth,
            options.height,
            tuple(options.angles),
        )
    wish = Wish(
        source,
        options.size,
        options.h or options.size,
        name=options.name,
        body=options.body,
        part=options.part,
        unit=options.unit,
        origin=options.origin,
        keep=options.keep,
        turn=options.turn,
        strip=options.strip,
        angle=options.min_angle,
        force=options.force,
    )
    crack = make_crack(wish)
    write_crack(options.output, crack.surface, crack.fronts, crack.unit)
    print(f"{options.output}: crack of {options.surface}")
    print("\n".join(report(wish, crack)))
