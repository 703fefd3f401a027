"""A picture (PNG) and a page to turn by the mouse (HTML) of prepared files.

    xmpm-prep view body.h5 flaw.h5 -o scene.png

Bodies are shown by the cells that their particles fill, sets by the faces of their particles,
cracks with their triangles and fronts, the grid by its lines behind all. Look at it before the run.
"""

from pathlib import Path

from xmpm_prep.errors import PrepError, warn

HELP = "a picture and a page of bodies, sets, cracks, fronts and grid"


def add_arguments(parser):
    """Options of the command."""
    parser.add_argument("files", metavar="FILE.h5", type=Path, nargs="+", help="prepared files")
    parser.add_argument(
        "-o", "--output", type=Path, help="picture to write (default: of the first file's name)"
    )
    parser.add_argument("--no-html", action="store_true", help="no page beside the picture")
    parser.add_argument("--h", type=float, help="cell size (default: that of the particle file)")
    parser.add_argument("--no-grid", action="store_true", help="without the lines of the grid")
    parser.add_argument("--renderer", choices=["pyvista", "matplotlib"], help="default: by trial")


def run(options):
    """Read, draw, say where."""
    from xmpm_prep.files import whole_files
    from xmpm_prep.page import write_page
    from xmpm_prep.picture import draw

    output = options.output or options.files[0].with_suffix(".png")
    if output.suffix.lower() != ".png":
        raise PrepError(f"{output}: the picture must end in .png")
    scene = read_scene(options)
    for note in scene.notes:
        warn(note)
    outputs = [output] if options.no_html else [output, output.with_suffix(".html")]
    with whole_files(*outputs) as temporary:
        renderer = draw(scene, temporary[0], options.renderer)
        if not options.no_html:
            write_page(scene, temporary[1], output.stem)
    low, high = scene.bounds()
    extent = " x ".join(f"{value:.6g}" for value in high - low)
    print(f"{' and '.join(map(str, outputs))}: {extent} {scene.unit} ({renderer})")


def read_scene(options):
    """Everything in the files, and the grid."""
    from xmpm_prep.kinds import sort_files
    from xmpm_prep.particle_file import read_particles
    from xmpm_prep.scene import Scene, add_crack, add_grid, add_particles

    particles, cracks = sort_files(options.files)
    scene = Scene()
    size, origin = options.h, (0.0, 0.0, 0.0)
    for path in particles:
        cloud = read_particles(path)
        if scene.unit and cloud.unit != scene.unit:
            scene.notes.append(f"{path} is in {cloud.unit}, the others in {scene.unit}")
        add_particles(scene, cloud)
        size = size or cloud.attributes.get("cell_size")
        origin = cloud.attributes.get("origin", origin)
    for path in cracks:
        add_crack(scene, path)
    if not scene.items:
        raise PrepError("there is nothing to show in these files")
    if size and not options.no_grid:
        add_grid(scene, float(size), origin)
    return scene
