"""Particles of the bodies of a model, for `file = ...` of *BODY.

MODEL is geometry (.geo, .step, .brep, .iges), a volume mesh (.msh, .vtk, .vtu, .inp, .bdf, .med and
what else meshio reads) or a closed surface (.stl). Physical volumes become bodies: `wheel` or, with
its material, `wheel:steel`. Physical surfaces become sets of particles for loads and conditions.

lattice     sub-cells of the grid inside the body; those at its surface keep their true cut volume
conforming  parts of the tetrahedra or hexahedra of a volume mesh, which gmsh makes of geometry

Beside body.h5 come body.vtkhdf, for ParaView, and body.xdmf, for meshio.
"""

from pathlib import Path

import numpy as np

from xmpm_prep.errors import PrepError, doubt
from xmpm_prep.units import METRES

HELP = "particles of the bodies of a model"


def add_arguments(parser):
    """Options of the command."""
    parser.add_argument("model", metavar="MODEL", type=Path, help="geometry, mesh or STL")
    parser.add_argument("--h", type=float, required=True, help="cell size of the grid")
    parser.add_argument(
        "--per-cell", type=int, default=2, help="particles a cell and direction, 1 to 4 (default 2)"
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="file to write, body.h5")
    parser.add_argument(
        "--way",
        choices=["lattice", "conforming"],
        default="lattice",
        help="how the particles lie (default lattice)",
    )
    parser.add_argument(
        "--origin",
        type=float,
        nargs=3,
        default=(0.0, 0.0, 0.0),
        metavar=("X", "Y", "Z"),
        help="a node of the grid (default 0 0 0)",
    )
    parser.add_argument(
        "--unit", choices=METRES, help="unit of length (default: of the STEP file, else m)"
    )
    parser.add_argument("--bodies", nargs="+", metavar="NAME", help="these bodies only")
    parser.add_argument("--sets", nargs="*", metavar="NAME", help="these sets only")
    parser.add_argument(
        "--all-faces", action="store_true", help="a set surface_N of each surface of geometry"
    )
    parser.add_argument("--material", help="material of all bodies")
    parser.add_argument("--force", action="store_true", help="go on where a mistake is suspected")


def run(options):
    """Read, fill, write, report."""
    from xmpm_prep.conforming import fill_mesh
    from xmpm_prep.lattice import fill_lattice
    from xmpm_prep.model import choose, read_model
    from xmpm_prep.particle_file import write_particles

    check(options)
    spacing = options.h / options.per_cell
    conforming = options.way == "conforming"
    # Tetrahedra of edge 2 s have about the volume s**3.
    model = read_model(
        options.model, options.h, 2 * spacing if conforming else None, options.all_faces
    )
    choose(model, options.bodies, options.sets)
    unit = unit_of(options, model)
    check_model(options, model, unit)
    for note in model.notes:
        print(f"note: {note}")
    origin = np.asarray(options.origin, float)
    clouds = []
    for body in model.bodies:
        if options.material:
            body.material = options.material
        if conforming:
            clouds.append(fill_mesh(model, body, spacing))
        else:
            clouds.append(fill_lattice(model, body, spacing, origin))
    attributes = {
        "cell_size": options.h,
        "per_cell": options.per_cell,
        "origin": origin,
        "way": options.way,
        "model": options.model.name,
        "model_volumes": [body.volume for body in model.bodies],
    }
    write_particles(options.output, model.bodies, clouds, unit, attributes)
    report(options, model, clouds, unit)


def check(options):
    """Options that no model could meet."""
    if not (options.h > 0 and np.isfinite(options.h)):
        raise PrepError(f"--h must be positive, not {options.h:g}")
    if not 1 <= options.per_cell <= 4:
        raise PrepError(f"--per-cell must be 1 to 4, not {options.per_cell}")
    if not np.isfinite(options.origin).all():
        raise PrepError("--origin must be finite")
    if options.output.suffix.lower() not in (".h5", ".hdf5"):
        raise PrepError(f"{options.output}: the file to write must end in .h5")
    if options.material == "":
        raise PrepError("--material must not be empty")


def unit_of(options, model):
    """Unit of the numbers: the one that the model states, or the one asked for."""
    if model.unit and options.unit and model.unit != options.unit:
        raise PrepError(
            f"{options.model}: the file is in {model.unit}, --unit is {options.unit}: mixed units "
            f"(nothing is converted; give --h in {model.unit} and --unit {model.unit})"
        )
    return model.unit or options.unit or "m"


def check_model(options, model, unit):
    """Models that cannot be right, or are unlikely to be."""
    from xmpm_prep.doubts import mixed_units, thin_wall

    names = [body.name for body in model.bodies]
    for name in names:
        if names.count(name) > 1:
            raise PrepError(f"{options.model}: two bodies have the name '{name}'")
    for name in model.set_names:
        if "/" in name or name in (".", ".."):
            raise PrepError(f"{options.model}: a set cannot have the name '{name}'")
    if options.way == "conforming" and not all(body.cells for body in model.bodies):
        raise PrepError(
            f"{options.model}: a surface without a volume mesh; the conforming way needs "
            "tetrahedra or hexahedra"
        )
    complaint = mixed_units(model, options.h, unit)
    if complaint:
        doubt(complaint, options.force)
    for body in model.bodies:
        complaint = thin_wall(model, body, options.h)
        if complaint:
            doubt(complaint, options.force)


def report(options, model, clouds, unit):
    """What was made, against what the model says."""
    print(f"{options.output}: lengths in {unit}, {options.way}, cells of {options.h:g}")
    for body, cloud in zip(model.bodies, clouds, strict=True):
        volume = float(cloud.volumes.sum())
        print(
            f"body {body.name}: material {body.material}, {len(cloud.volumes)} particles, volume "
            f"{volume:.10g} {unit}^3, of the model {body.volume:.10g} "
            f"({100 * (volume / body.volume - 1):+.4f} %)"
        )
    for name in model.set_names:
        patches = [cloud.sets[name] for cloud in clouds if name in cloud.sets]
        count = sum(len(patch.particles) for patch in patches)
        total = np.concatenate([patch.areas for patch in patches])
        vector = total.sum(axis=0)
        print(
            f"set {name}: {count} particles, area {np.linalg.norm(total, axis=1).sum():.8g} "
            f"{unit}^2, resultant ({vector[0]:.6g} {vector[1]:.6g} {vector[2]:.6g})"
        )
