"""Figures, pictures and the reader of results, from small files and from one true run."""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.image import imread

from xmpm_post import PostError, open_run
from xmpm_post import jump as jump_module
from xmpm_post.cli import main
from xmpm_post.render import RENDERERS, can_render

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = (
    "time,step,crack,front,point,s,x,y,z,J,K_I,K_II,K_III,J_low,J_high,K_I_low,K_I_high,"
    "K_II_low,K_II_high,K_III_low,K_III_high,T,kink_angle,K_star,tip_speed,flags,radius"
)
TIMES, POINTS = (0.0, 0.5, 1.0), 6

DECK = """
*JOB small
*UNITS    length = mm, mass = g, time = ms
*GRID     size = 2
*MATERIAL steel
  law = elastic, density = 7.9e-3, young = 2e5, poisson = 0.3
*BODY block
  material = steel, box = -12 -12 -12 12 12 12
*CRACK penny
  disc, centre = 0 0 0, along = 1 0 0, across = 0 1 0, radius = 6
*LOAD     face = block:+z, traction = 0 0 100
*LOAD     face = block:-z, traction = 0 0 -100
*TIME     end = 0.004
*OUTPUT   every = 0.002, history = 0.001
*FRACTURE every = 0.001, radii = 4
*END
"""


def write_front(path: Path) -> None:
    """A circular front of six points; K_I = 10 t (1 + point), K_II = -t, J = t."""
    rows = []
    for step, time in enumerate(TIMES):
        for point in range(1, POINTS + 1):
            angle = 2 * np.pi * (point - 1) / POINTS
            k = 10 * time * (1 + point)
            place = [point - 1.0, np.cos(angle), np.sin(angle), 0.0]
            spread = [0.9 * time, 1.1 * time, 0.9 * k, 1.1 * k, -time, -time, 0, 0]
            values = [*place, time, k, -time, 0, *spread, "nan", 0.1, k, 0, 8 * (point == 1), 1.5]
            rows.append(",".join(map(str, [time, step, "disc", 1, point, *values])))
    units = "ms,1,,1,1,mm,mm,mm,mm,g/ms2,u,u,u"
    head = f"# program: XMPM3D\n# unit_system: mm g ms\n# units: {units}\n{COLUMNS}\n"
    path.write_text(head + "\n".join(rows) + "\n")


def write_poly_data(path, points, fields, lines=(), triangles=()):
    """Poly data of one step as the program writes it."""
    groups = {
        "Vertices": [] if len(triangles) else [np.arange(len(points))],
        "Lines": lines,
        "Polygons": triangles,
        "Strips": [],
    }
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 2]
        root.attrs["Type"] = np.bytes_("PolyData")
        root["Points"] = points
        root["NumberOfPoints"] = [len(points)]
        for name, cells in groups.items():
            ids = np.concatenate([np.zeros(0, int), *map(np.asarray, cells)])
            root[f"{name}/NumberOfCells"] = [len(cells)]
            root[f"{name}/NumberOfConnectivityIds"] = [len(ids)]
            root[f"{name}/Connectivity"] = ids
            root[f"{name}/Offsets"] = np.cumsum([0, *map(len, cells)])
        for name, values in fields.items():
            root[f"PointData/{name}"] = values
            root[f"PointData/{name}"].attrs["unit"] = np.bytes_("mm")


@pytest.fixture
def run(tmp_path):
    """Block whose upper half (y > 0) moved up by 0.1 and whose lower half moved down; tables."""
    axis = np.arange(-5, 5) + 0.5
    x, y, z = (part.ravel() for part in np.meshgrid(axis, axis, axis[:4], indexing="ij"))
    displacement = np.zeros((len(x), 3))
    displacement[:, 1] = 0.1 * np.sign(y)
    corners = [[-3, 0, -6], [-3, 0, 0], [3, 0, 0], [3, 0, -6]]  # normal towards +y
    write_poly_data(
        tmp_path / "a_particles.vtkhdf",
        np.column_stack([x, y, z]) + displacement,
        {"displacement": displacement.astype("f4")},
    )
    write_poly_data(
        tmp_path / "a_crack.vtkhdf",
        np.array(corners, float),
        {"crack": np.ones(4), "height": np.arange(4.0)},
        lines=[[1, 2]],
        triangles=[[0, 1, 2], [0, 2, 3]],
    )
    write_front(tmp_path / "a_front.csv")
    (tmp_path / "a_energy.csv").write_text(
        "# unit_system: mm g ms\n# units: ms,J,J,1\ntime,kinetic,strain,relative_error\n"
        "0,0,0,0\n1,2,1,-0.02\n2,1,2,0.01\n"
    )
    return tmp_path / "a"


@pytest.fixture(scope="module")
def true_run(tmp_path_factory):
    """A penny-shaped crack under sudden tension, run by the program."""
    built = sorted(ROOT.glob("build/*/bin/xmpm3d"), key=lambda path: path.stat().st_mtime)
    program = os.environ.get("XMPM3D") or (built and built[-1])
    if not program:
        pytest.skip("no program: set XMPM3D, or build the preset release")
    folder = tmp_path_factory.mktemp("true")
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    subprocess.run(
        [program, "-o", folder], input=DECK, text=True, env=root | os.environ, check=True,
        timeout=120, capture_output=True,
    )  # fmt: skip
    return folder


def picture_has_colours(path, least=0.01):
    image = imread(path)[:, :, :3]
    return (np.ptp(image, axis=2) > 0.2).mean() > least


# --- reader ------------------------------------------------------------------------------------


def test_columns_units_and_provenance_are_read(run):
    front = open_run(run).front
    assert len(front) == len(TIMES) * POINTS
    assert front.unit("J") == "g/ms2"
    assert front.provenance == {"program": "XMPM3D", "unit_system": "mm g ms"}
    assert front["crack"][0] == "disc"
    assert np.isnan(front["T"]).all()


def test_rows_are_chosen_by_value_and_by_the_nearest_time(run):
    rows = open_run(run).front.where(crack="disc", time=0.6, point=3)
    assert rows["time"].tolist() == [0.5]
    assert rows["K_I"].tolist() == [20.0]


@pytest.mark.parametrize("end", ["", "_front.csv", "_crack.vtkhdf"])
def test_a_run_is_found_by_name_by_file_and_by_folder(run, end):
    assert open_run(f"{run}{end}").name == "a"
    assert open_run(run.parent).name == "a"


def test_a_row_that_was_not_finished_is_left_out(run):
    path = run.with_name("a_energy.csv")
    path.write_text(path.read_text() + "3,1.5")
    assert len(open_run(run).energy) == 3


def test_poly_data_without_steps_is_read(run):
    crack = open_run(run).crack()
    assert crack.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert [line.tolist() for line in crack.lines] == [[1, 2]]
    assert crack.units["height"] == "mm"


def test_a_true_run_is_read_step_by_step(true_run):
    run = open_run(true_run)
    assert run.energy["time"][-1] == pytest.approx(0.004, rel=0.05)  # half a step before the end
    assert run.times() == pytest.approx([0, 0.002, 0.004], abs=1e-4)  # within a time step
    first, last = run.particles(0.0), run.particles()
    assert len(first.points) == len(last.points) == 12**3 * 8
    assert np.abs(first.fields["displacement"]).max() == 0
    # Points are where they were plus the displacement, which is single precision.
    moved = last.points - last.fields["displacement"]
    order, other = np.lexsort(np.round(first.points.T, 3)), np.lexsort(np.round(moved.T, 3))
    assert np.allclose(first.points[order], moved[other], atol=1e-5)
    crack = run.crack()
    assert crack.fields["opening"].shape == (len(crack.points), 3)
    front = crack.points[crack.lines[0]]
    assert np.linalg.norm(front, axis=1) == pytest.approx(6, rel=1e-3)  # a disc of radius 6
    assert crack.lines[0][0] == crack.lines[0][-1]
    rows = run.front.where(time=0.004)
    assert np.hypot(rows["x"], rows["y"]) == pytest.approx(6, rel=1e-3)
    assert (rows["K_I_low"] <= rows["K_I"]).all()
    assert (rows["K_I"] <= rows["K_I_high"]).all()
    assert rows["K_I"].min() > 0  # pulled open


# --- commands ----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["pdf", "png"])
def test_k_draws_history_and_front(run, kind, capsys):
    assert main(["k", str(run), "--format", kind]) == 0
    said = capsys.readouterr().out
    for name in ("a_k_time", "a_k_front"):
        path = run.with_name(f"{name}.{kind}")
        assert str(path) in said
        assert path.stat().st_size > 5000
        assert kind == "pdf" or picture_has_colours(path, 0.002)
    assert "end of the front 3" in said  # point 1 at three times


def test_k_takes_points_times_quantities_and_references(run, tmp_path):
    reference = tmp_path / "reference.csv"
    reference.write_text("# label: exact\ntime,K_I\n0,0\n1,20\n")
    folder = tmp_path / "figures"
    given = ["--points", "1", "4", "--times", "0.5", "--quantities", "K_I", "K_star"]
    options = [*given, "--reference", str(reference), "-o", str(folder), "--format", "svg"]
    assert main(["k", str(run), *options]) == 0
    assert "exact" in (folder / "a_k_time.svg").read_text()  # as a comment of the glyphs' group
    assert (folder / "a_k_front.svg").is_file()


def test_energy_says_its_largest_error(run, capsys):
    assert main(["energy", str(run), "--format", "png"]) == 0
    assert "-2 % at t = 1" in capsys.readouterr().out
    assert picture_has_colours(run.with_name("a_energy.png"), 0.002)


@pytest.mark.parametrize("renderer", RENDERERS)
@pytest.mark.parametrize("along", [None, "K_I"])
def test_crack_is_drawn_with_its_fronts(run, renderer, along):
    if renderer == "pyvista" and not can_render():
        pytest.skip("VTK cannot render without a screen here")
    picture = run.parent / "pictures" / "crack.png"
    options = ["--field", "height", "--renderer", renderer, "-o", str(picture)]
    assert main(["crack", str(run), *options, *(["--along", along] if along else [])]) == 0
    assert picture_has_colours(picture, 0.05)


@pytest.mark.parametrize("renderer", RENDERERS)
def test_jump_is_drawn_in_two_panels(run, renderer, capsys):
    if renderer == "pyvista" and not can_render():
        pytest.skip("VTK cannot render without a screen here")
    picture = run.parent / "pictures" / f"{renderer}.png"
    assert main(["jump", str(run), "-o", str(picture), "--renderer", renderer]) == 0
    assert "jump up to 0.2" in capsys.readouterr().out
    image = imread(picture)[:, :, :3]
    assert image.shape == (700, 1600, 3)
    for half in (image[:, :800], image[:, 800:]):
        assert (np.ptp(half, axis=2) > 0.2).mean() > 0.02  # something in colour in either panel


def test_jump_is_found_from_the_particles_on_both_sides(run):
    scene = jump_module.make_scene(open_run(run).particles(), open_run(run).crack())
    assert scene.jump == pytest.approx([0.2] * 4, rel=1e-6)  # float32 displacements
    assert np.allclose(scene.normal, [0, 1, 0])
    assert set(np.round(scene.values, 6)) == {-0.1, 0.1}
    assert abs(scene.view[1]) == 0  # looks along the crack, not onto it


def test_labels_of_the_jump_have_units(run):
    results = open_run(run)
    scene = jump_module.make_scene(results.particles(), results.crack(), time_unit="ms")
    assert scene.title.startswith("t = ") and " ms, displacements x " in scene.title
    for label in (scene.label, scene.jump_label):
        assert label.endswith(" [mm]")


def test_verify_draws_a_figure_a_case(tmp_path, capsys):
    table = tmp_path / "verification.csv"
    table.write_text(
        "case,method,h,ranks,quantity,value,reference,error,limit,cpu_s\n"
        "penny,graded,1,1,K_I,0.98,1,0.02,0.01,5\npenny,graded,0.5,1,K_I,0.99,1,0.01,0.01,60\n"
        "penny,full,1,1,K_I,1.04,1,0.04,,5\nbar,musl,1,1,order,1,2,0,,0\n"
    )
    assert main(["verify", str(table), "--format", "png"]) == 0
    assert picture_has_colours(tmp_path / "verification_penny.png", 0.002)
    assert "bar: no errors above zero" in capsys.readouterr().out


def test_all_commands_draw_a_true_run(true_run):
    renderer = "pyvista" if can_render() else "matplotlib"
    assert main(["energy", str(true_run)]) == 0
    assert main(["k", str(true_run), "--format", "png"]) == 0
    assert picture_has_colours(true_run / "small_k_time.png", 0.002)
    assert main(["crack", str(true_run), "--along", "K_I", "--renderer", renderer]) == 0
    for command in ("crack", "jump"):
        assert main([command, str(true_run), "--renderer", renderer]) == 0
        assert picture_has_colours(true_run / f"small_{command}.png", 0.05)


# --- faults ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["k", "@/b"], "no such run; in @ there are: a"),
        (["k", "@/none/b"], "no such folder"),
        (["k", "@/a", "--crack", "slit"], "no crack slit; there are: disc"),
        (["k", "@/a", "--front", "2"], "no front 2; there are: 1"),
        (["k", "@/a", "--points", "7"], "no point 7; this front has 1 to 6"),
        (["k", "@/a", "--quantities", "K_IV"], "no column K_IV; there are: time, step"),
        (["k", "@/a", "--reference", "@/a_energy.csv"], "a reference needs a column time or s"),
        (["k", "@/a", "--reference", "@/r.csv"], "r.csv: no such file"),
        (["crack", "@/a"], "no field opening; there are: crack, height"),
        (["verify", "@/v.csv"], "v.csv: no such file"),
    ],
)
def test_a_request_that_cannot_be_met_is_told_in_one_line(run, capsys, arguments, text):
    arguments = [argument.replace("@", str(run.parent)) for argument in arguments]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert text.replace("@", str(run.parent)) in said
    assert said.count("\n") == 1


def test_missing_front_file_names_the_keyword(run):
    run.with_name("a_front.csv").unlink()
    with pytest.raises(PostError, match="FRACTURE"):
        _ = open_run(run).front


def test_missing_displacement_says_what_to_ask_for(run):
    crack = open_run(run).crack()
    with pytest.raises(PostError, match=r"\*OUTPUT"):
        jump_module.make_scene(crack, crack)


def test_crack_without_surface_is_reported(run):
    particles = open_run(run).particles()
    with pytest.raises(PostError, match="no triangles"):
        jump_module.make_scene(particles, particles)


def test_a_file_that_is_no_hdf5_is_named(run):
    run.with_name("a_crack.vtkhdf").write_text("nothing")
    with pytest.raises(PostError, match="not an HDF5 file"):
        open_run(run).crack()
