"""A commented deck to start from, for prepared files.

    xmpm-prep deck body.h5 flaw.h5 -o job.inp

`xmpm3d --check job.inp` accepts it as it stands. Materials are steel for want of better, and
nothing moves before a load is chosen: what has to be looked at is marked with `<--`.
"""

import re
from pathlib import Path

import numpy as np

from xmpm_prep.errors import PrepError
from xmpm_prep.units import METRES

HELP = "a commented deck for prepared files"
# Mass and time that go with a length, and names of stress and force where they have one.
SYSTEMS = {
    "m": ("kg", "s", "stress in Pa, force in N"),
    "mm": ("g", "ms", "stress in MPa, force in N"),
    "cm": ("g", "us", "stress in 100 GPa, force in 10 MN"),
    "um": ("mg", "us", "stress in TPa, force in N"),
    "km": ("t", "s", "stress in Pa, force in MN"),
    "in": ("kg", "s", "stress in kg/(in s2)"),
    "ft": ("kg", "s", "stress in kg/(ft s2)"),
}
KILOGRAMS = {"kg": 1.0, "g": 1e-3, "t": 1e3, "mg": 1e-6}
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
DENSITY, YOUNG, POISSON = 7850.0, 210e9, 0.3  # steel [kg/m3], [Pa]


def add_arguments(parser):
    """Options of the command."""
    parser.add_argument("files", metavar="FILE.h5", type=Path, nargs="+", help="prepared files")
    parser.add_argument("-o", "--output", type=Path, help="deck to write (default: print it)")
    parser.add_argument("--job", help="name of the run (default: that of the deck, else run)")
    parser.add_argument("--h", type=float, help="cell size (default: that of the particle file)")


def run(options):
    """Read what was prepared, write the deck."""
    from xmpm_prep.files import whole_files
    from xmpm_prep.kinds import sort_files
    from xmpm_prep.particle_file import read_particles

    paths, cracks = sort_files(options.files)
    if not paths:
        raise PrepError("a deck needs a particle file, made by: xmpm-prep particles")
    clouds = [read_particles(path) for path in paths]
    check(options, clouds, cracks)
    job = options.job or (options.output.stem if options.output else "run")
    text = "\n".join(lines_of(options, job, clouds, cracks)) + "\n"
    if options.output is None:
        print(text, end="")
        return
    with whole_files(options.output) as (temporary,):
        temporary.write_text(text, encoding="utf-8")
    print(f"{options.output}: try it with: xmpm3d --check {options.output}")


def check(options, clouds, cracks):
    """Files that one deck can name."""
    from xmpm_prep.kinds import unit_of

    for cloud in clouds[1:]:
        if cloud.unit != clouds[0].unit:
            raise PrepError(
                f"{cloud.path} is in {cloud.unit}, {clouds[0].path} in {clouds[0].unit}: "
                "a deck has one unit of length"
            )
    for path in cracks:
        unit = unit_of(path)
        if unit != clouds[0].unit:
            raise PrepError(
                f"{path} is in {unit}, {clouds[0].path} in {clouds[0].unit}: "
                "a deck has one unit of length"
            )
    names = [name for cloud in clouds for name in cloud.body_names]
    for name in names:
        if names.count(name) > 1:
            raise PrepError(f"two particle files have a body of the name '{name}'")
    sizes = {float(cloud.attributes["cell_size"]) for cloud in clouds if has_size(cloud)}
    if options.h is None and len(sizes) != 1:
        found = " and ".join(f"{size:g}" for size in sorted(sizes)) or "no cell size"
        raise PrepError(f"the particle files say {found}: give the one to use by --h")
    if options.h is not None and not options.h > 0:
        raise PrepError(f"--h must be positive, not {options.h:g}")


def has_size(cloud):
    """Whether a particle file says for which cells it was made."""
    return "cell_size" in cloud.attributes


def quoted(text):
    """A text as a value of the deck."""
    text = str(text)
    return text if re.fullmatch(r"[A-Za-z_][\w.+-]*", text) else f'"{text}"'


def number(value):
    """A number, short and exact enough."""
    return f"{value:.10g}"


def lines_of(options, job, clouds, cracks):
    """The lines of the deck."""
    length = clouds[0].unit
    if length not in METRES:
        raise PrepError(f"{clouds[0].path}: the unit of length '{length}' is none of the deck's")
    mass, time, derived = SYSTEMS[length]
    metre, kilogram, second = METRES[length], KILOGRAMS[mass], SECONDS[time]
    first = next((cloud for cloud in clouds if has_size(cloud)), clouds[0])
    h = options.h or float(first.attributes["cell_size"])
    origin = [number(float(x)) for x in first.attributes.get("origin", (0, 0, 0))]
    # Time for a wave to run through the largest extent, and back.
    extent = max(float(np.ptp(cloud.positions, axis=0).max()) + h for cloud in clouds)
    speed = (YOUNG / DENSITY) ** 0.5 * second / metre
    end = float(f"{2 * extent / speed:.2g}")

    lines = [
        f"! Deck to start from, made by xmpm-prep of {', '.join(map(str, options.files))}.",
        "! Look at every line with <-- before the first run. doc/deck.md explains all keys.",
        "! Paths of files are relative to the folder in which xmpm3d is started.",
        "",
        f"*JOB {quoted(job)}",
        f"*UNITS length = {length}, mass = {mass}, time = {time}   ! {derived}",
        "",
        f"*GRID size = {number(h)}, shape = linear, origin = {' '.join(origin)}",
    ]
    lines += material_lines(clouds, kilogram, metre, second)
    for cloud in clouds:
        per_cell = int(cloud.attributes.get("per_cell", 2))
        for name, material in zip(cloud.body_names, cloud.materials, strict=True):
            lines += [
                "",
                f"*BODY {quoted(name)}",
                f"  material = {quoted(material)}, particles = {per_cell}",
                f'  file = "{cloud.path}", part = {quoted(name)}',
            ]
    for path in cracks:
        lines += ["", f"*CRACK {quoted(path.stem)}", f'  file = "{path}"']
    lines += condition_lines(clouds, h)
    lines += [
        "",
        f"*TIME end = {number(end)}, scheme = musl, cfl = 0.5   "
        "! <-- twice through the largest body by a wave in steel",
        f"*OUTPUT every = {number(end / 20)}, history = {number(end / 200)}",
        "  particles = displacement velocity stress" + (", crack = opening" if cracks else ""),
        "*END",
    ]
    return lines


def material_lines(clouds, kilogram, metre, second):
    """A block for every material; all of them steel."""
    lines = []
    for name in dict.fromkeys(name for cloud in clouds for name in cloud.materials):
        lines += [
            "",
            f"*MATERIAL {quoted(name)}   ! <-- values of steel: put in those of {name}",
            f"  law = elastic, density = {number(DENSITY * metre**3 / kilogram)}, "
            f"young = {number(YOUNG * metre * second**2 / kilogram)}, poisson = {POISSON}",
        ]
    return lines


def condition_lines(clouds, h):
    """Loads and conditions on the sets, to be chosen from: all of them are comments."""
    lines = ["", "! <-- Nothing acts yet. Take away the ! of what is to act, and put in values."]
    names = sorted({name for cloud in clouds for name in cloud.sets})
    loaded = {name for cloud in clouds for name in cloud.loaded}
    for name in names:
        if name in loaded:
            lines.append(f"! *LOAD {quoted(name)} set = {quoted(name)}, traction = 0 0 1")
        lines.append(f"! *BOUNDARY {quoted(name)} set = {quoted(name)}, type = fixed")
    if not names:
        place = min(float(cloud.positions[:, 2].min()) for cloud in clouds)
        plane = number(h * round(place / h))
        lines.append(f"! *BOUNDARY foot plane = z {plane}, type = roller   ! a plane of grid nodes")
    lines.append("! *GRAVITY acceleration = 0 0 -9.81   ! in m/s2: mind the units")
    return lines
