"""The picture of the displacement jump is drawn by both renderers from the program's own files."""

import importlib.util
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.image import imread

ROOT = Path(__file__).resolve().parents[2]


def load_script():
    """The script as a module."""
    path = ROOT / "postproc" / "jump_picture.py"
    specification = importlib.util.spec_from_file_location("jump_picture", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


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


@pytest.fixture
def scene_files(tmp_path):
    """A block whose upper half (y > 0) moved up by 0.2 and whose lower half moved down."""
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
        {"crack": np.ones(4)},
        lines=[[1, 2]],
        triangles=[[0, 1, 2], [0, 2, 3]],
    )
    return tmp_path / "a_particles.vtkhdf", tmp_path / "a_crack.vtkhdf"


def test_jump_is_found_from_the_particles_on_both_sides(scene_files):
    script = load_script()
    particles, time = script.read_step(scene_files[0])
    crack, _ = script.read_step(scene_files[1], time)
    scene = script.make_scene(particles, crack, 0.0, None)
    assert scene.jump == pytest.approx([0.2] * 4, rel=1e-6)  # float32 displacements
    assert np.allclose(scene.normal, [0, 1, 0])
    assert set(np.round(scene.values, 6)) == {-0.1, 0.1}
    assert abs(scene.view[1]) == 0  # looks along the crack, not onto it


@pytest.mark.parametrize("renderer", ["pyvista", "matplotlib"])
def test_picture_is_drawn(scene_files, tmp_path, renderer, capsys):
    script = load_script()
    if renderer == "pyvista" and not script.can_render():
        pytest.skip("VTK cannot render without a screen here")
    picture = tmp_path / "pictures" / f"{renderer}.png"
    script.main([*map(str, scene_files), "-o", str(picture), "--renderer", renderer])
    assert "jump up to 0.2" in capsys.readouterr().out
    image = imread(picture)[:, :, :3]
    assert image.shape == (700, 1600, 3)
    for half in (image[:, :800], image[:, 800:]):
        coloured = np.ptp(half, axis=2) > 0.2
        assert coloured.mean() > 0.02  # something is drawn in colour in either panel


def test_missing_file_is_named(tmp_path):
    script = load_script()
    with pytest.raises(SystemExit, match="no such file"):
        script.main([str(tmp_path / "x.vtkhdf"), str(tmp_path / "y.vtkhdf"), "-o", "z.png"])


def test_missing_displacement_says_what_to_ask_for(scene_files):
    script = load_script()
    crack, _ = script.read_step(scene_files[1])
    with pytest.raises(SystemExit, match="displacement"):
        script.make_scene(crack, crack, 0.0, None)


def test_crack_without_surface_is_reported(scene_files):
    script = load_script()
    particles, _ = script.read_step(scene_files[0])
    with pytest.raises(SystemExit, match="no triangles"):
        script.make_scene(particles, particles, 0.0, None)
