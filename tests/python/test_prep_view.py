"""`xmpm-prep view` draws what the files hold, as a picture and as a page."""

import base64
import json
import re
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from matplotlib.image import imread

from xmpm_prep.cli import main
from xmpm_prep.kinds import sort_files
from xmpm_prep.particle_file import read_particles
from xmpm_prep.picture import can_render
from xmpm_prep.scene import Scene, add_crack, add_grid, add_particles

BLOCK = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 12, 8, 4};
Physical Volume("block") = {1};
e = 0.01;
Physical Surface("left") = Surface In BoundingBox{-e, -e, -e, e, 8 + e, 4 + e};
"""


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    """A block with a set, and a crack in it."""
    folder = tmp_path_factory.mktemp("view")
    (folder / "block.geo").write_text(BLOCK)
    body, crack = folder / "block.h5", folder / "penny.h5"
    assert main(["particles", str(folder / "block.geo"), "--h", "2", "-o", str(body)]) == 0
    shape = ["crack", "disc", "--radius", "1.5", "--centre", "6", "4", "2", "--size", "0.5"]
    assert main([*shape, "--body", str(body), "-o", str(crack)]) == 0
    return body, crack


def area(items):
    """Area of the triangles of items."""
    total = 0.0
    for item in items:
        a, b, c = (item.points[item.cells[:, i]] for i in range(3))
        total += np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return total


def test_faces_of_bodies_and_sets_make_up_the_surface(prepared):
    scene = Scene()
    add_particles(scene, read_particles(prepared[0]))
    assert area(scene.of_kind("set")) == pytest.approx(8 * 4)
    assert area(scene.of_kind("body", "set")) == pytest.approx(2 * (12 * 8 + 8 * 4 + 12 * 4))
    assert [item.name for item in scene.items] == ["set left", "body block"]
    low, high = scene.bounds()
    assert np.allclose([*low, *high], [0, 0, 0, 12, 8, 4])


def test_set_is_whole_where_a_cell_holds_many_particles(prepared, tmp_path):
    model, path = prepared[0].with_suffix(".geo"), tmp_path / "mesh.h5"
    assert main(["particles", str(model), "--h", "2", "--way", "conforming", "-o", str(path)]) == 0
    scene = Scene()
    add_particles(scene, read_particles(path))
    assert area(scene.of_kind("set")) == pytest.approx(8 * 4)  # cells of 2 fill the block


def test_crack_has_its_front_and_the_grid_its_cells(prepared):
    scene = Scene()
    add_crack(scene, prepared[1])
    front = scene.of_kind("front")[0]
    ends = front.points[front.cells]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * np.pi * 1.5, rel=0.02)  # 19 chords of a circle: 0.5 %
    add_grid(scene, 2.0, (0.5, 0.0, 0.0))
    lines = scene.of_kind("grid")[0]
    assert np.allclose((lines.points - [0.5, 0, 0]) % 2, 0)


@pytest.mark.parametrize("renderer", ["pyvista", "matplotlib"])
def test_picture_shows_bodies_sets_cracks_and_fronts(prepared, tmp_path, renderer, capsys):
    if renderer == "pyvista" and not can_render():
        pytest.skip("VTK cannot render without a screen here")
    picture = tmp_path / "new" / "scene.png"
    options = ["-o", str(picture), "--renderer", renderer, "--no-html"]
    assert main(["view", *map(str, prepared), *options]) == 0
    assert "12 x 8 x 4 m" in capsys.readouterr().out
    assert list(picture.parent.iterdir()) == [picture]
    image = imread(picture)[:, :, :3]
    assert image.shape == (900, 1800, 3)
    left, right = image[:, :900], image[:, 900:]
    grey_blue = (left[:, :, 2] > left[:, :, 0] + 0.03) & (left.max(axis=2) < 0.9)
    assert grey_blue.mean() > 0.1  # the block
    red = (right[:, :, 0] > 0.8) & (right[:, :, 1] < 0.3) & (right[:, :, 2] < 0.3)
    assert red.sum() > 100  # the front


def test_page_holds_the_scene_and_a_script_that_runs(prepared, tmp_path):
    picture = tmp_path / "scene.png"
    options = ["-o", str(picture), "--renderer", "matplotlib"]
    assert main(["view", *map(str, prepared), *options]) == 0
    text = picture.with_suffix(".html").read_text()
    found = re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.S)
    scene = json.loads(found.group(1))
    names = {item["name"] for item in scene["items"]}
    assert {"body block", "set left", "crack penny", "front of penny", "grid of 2"} <= names
    body = next(item for item in scene["items"] if item["name"] == "body block")
    points = np.frombuffer(base64.b64decode(body["points"]), "<f4").reshape(-1, 3)
    cells = np.frombuffer(base64.b64decode(body["cells"]), "<u4")
    assert np.abs(points).max() <= 1.0 + 1e-6  # about the middle, in units of half the diagonal
    assert cells.max() < len(points)
    assert "http" not in text.replace("http-equiv", "")  # needs no network
    if shutil.which("node"):
        script = text[text.index('"use strict"') : text.rindex("</script>")]
        (tmp_path / "page.js").write_text(script)
        subprocess.run(["node", "--check", str(tmp_path / "page.js")], check=True, timeout=60)


def test_name_cannot_end_the_script(prepared, tmp_path):
    body = tmp_path / "odd.h5"
    body.write_bytes(prepared[0].read_bytes())
    with h5py.File(body, "a") as file:
        del file["body_names"]
        file["body_names"] = ["</script><b>"]
    options = ["-o", str(tmp_path / "odd.png"), "--renderer", "matplotlib"]
    assert main(["view", str(body), *options]) == 0
    assert "</script><b>" not in (tmp_path / "odd.html").read_text()


def test_what_cannot_be_shown_gets_one_line(prepared, tmp_path, capsys):
    other = tmp_path / "other.h5"
    h5py.File(other, "w").close()
    text = tmp_path / "text.h5"
    text.write_text("no HDF5")
    for files, message, code in (
        ([tmp_path / "none.h5"], "no such file", 4),
        ([other], "format is 'None'", 4),
        ([text], "not a readable HDF5 file", 4),
        ([prepared[0], "-o", tmp_path / "a.jpg"], "must end in .png", 2),
    ):
        assert main(["view", *map(str, files)]) == code
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == 1
        assert message in lines[0]
    assert sorted(tmp_path.iterdir()) == [other, text]
    assert sort_files(prepared) == ([prepared[0]], [prepared[1]])
