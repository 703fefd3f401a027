"""The fronts of the paper's examples have the lengths that follow from their numbers."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipe

from xmpm_prep.crack_file import write_crack
from xmpm_prep.crack_front import BOUNDARY
from xmpm_prep.crack_read import read_crack
from xmpm_prep.model import read_model

INPUT = Path(__file__).resolve().parents[2] / "input"


def load_prepare():
    """The script input/prepare.py as a module."""
    spec = importlib.util.spec_from_file_location("prepare", INPUT / "prepare.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


prepare = load_prepare()


def quarter_of_ellipse(a, b):
    """A quarter of the circumference of an ellipse, a > b."""
    return a * ellipe(1 - (b / a) ** 2)


def rod_front():
    """The curve x = 16 cos t, y = 16 sin t in the plane z = (8 - x - y) / sqrt(3), a quarter."""
    t = (np.arange(10000) + 0.5) / 10000 * np.pi / 2
    slope = 16 * (np.sin(t) - np.cos(t)) / np.sqrt(3)
    return np.hypot(16.0, slope).mean() * np.pi / 2


# In the tube the fronts stand at y = -5 and 5 between the radii of 35 and 45.
WALL = np.sqrt(45**2 - 5**2) - np.sqrt(35**2 - 5**2)

LENGTHS = {
    "plate-1": [[10, 10]],
    "plate-2": [[10, 10]] * 2,
    "plate-4": [[10, 10]] * 4,
    "cylinder-penny": [[20 * np.pi]],
    "ellipse-bar": [[quarter_of_ellipse(35, 20)]],
    "bending-2mm": [[10]],
    "bending-5mm": [[10]],
    "bending-eccentric": [[10]],
    "rod-quarter": [[rod_front()]],
    "tube-crack": [[WALL, WALL]],
}
CLOSED = {"cylinder-penny"}


def test_every_example_has_geometry_and_deck():
    assert set(LENGTHS) == set(prepare.EXAMPLES)
    decks = {path.stem for path in INPUT.glob("*.inp")}
    assert decks == set(LENGTHS) | {"plate-0"}
    assert {path.stem for path in (INPUT / "geometry").glob("*.geo")} == set(LENGTHS)


@pytest.mark.parametrize("name", LENGTHS)
def test_fronts_of_an_example_are_found_with_the_right_length(name, tmp_path):
    h = prepare.EXAMPLES[name].h
    cracks = prepare.prepare(name, tmp_path, h)
    assert list(cracks) == list(prepare.EXAMPLES[name].cracks)
    for crack, lengths in zip(cracks.values(), LENGTHS[name], strict=True):
        found = [front.length for front in crack.fronts]
        # Chords of 2.5 on a radius of curvature of 11.4 or more: (2.5 / 11.4)**2 / 24 = 0.2 %; the
        # cut at the boundary is found to 1 / 200 of an edge of 2.
        assert found == pytest.approx(lengths, rel=2.5e-3)
        assert all(front.closed == (name in CLOSED) for front in crack.fronts)
        assert not (crack.kind == BOUNDARY).any()  # every other edge is well outside
        assert crack.surface.angles.min() > 20.0
        assert crack.unit == "mm"
    for crack in cracks:
        surface = read_crack(tmp_path / f"{crack}.h5")
        np.testing.assert_array_equal(surface.points, cracks[crack].surface.points)


@pytest.mark.parametrize("name", LENGTHS)
def test_the_prepared_deck_reads_the_prepared_cracks(name):
    deck = (INPUT / f"{name}.inp").read_text()
    changed = prepare.change_deck(deck, 3.5, coarse=True)
    assert re.search(r"(?m)^  h = 3\.5\b", changed)
    assert re.search(r"(?m)^\*TIME steps = 5, end", changed)
    blocks = re.findall(
        r"(?m)^\*CRACK (\S+)\n  file = \"(.*)\.h5\"\n(?=\*|  ramp|  contact)", changed
    )
    for key in ("ramp_end", "contact ="):
        assert changed.count(key) == deck.count(key)
    assert blocks == [(crack, crack) for crack in prepare.EXAMPLES[name].cracks]
    # What is no crack, no cell size and no length of the run stays as it is.
    others = re.compile(r"(?m)^\*(?!CRACK)(?!PARAMETER)(?!TIME)\w+.*\n(?:(?!\*).*\n)+")
    assert others.findall(changed) == others.findall(deck)


def test_files_of_cracks_keep_their_fronts(tmp_path):
    import h5py

    crack = prepare.prepare("tube-crack", tmp_path, 2.0)["slit"]
    write_crack(tmp_path / "again.h5", crack.surface, crack.fronts, "mm")
    with h5py.File(tmp_path / "again.h5") as file:
        edges, numbers = file["front_edges"][:], file["front_numbers"][:]
    for number, front in enumerate(crack.fronts):
        np.testing.assert_array_equal(edges[numbers == number], front.edges)


BODIES = {
    "plate": 400 * 120 * 10,
    "cylinder": np.pi * 50**2 * 90,
    "bar": 300 * 60 * 90,
    "beam": 400 * 100 * 10,
    "rod": 50 * 50 * 100,
    "tube": np.pi * (45**2 - 35**2) * 100,
}


@pytest.mark.parametrize("name", LENGTHS)
def test_geometry_and_deck_have_the_same_bodies(name):
    model = read_model(INPUT / "geometry" / f"{name}.geo", prepare.EXAMPLES[name].h)
    deck = (INPUT / f"{name}.inp").read_text()
    assert [body.name for body in model.bodies] == re.findall(r"(?m)^\*BODY (\S+)", deck)
    half = 5 if name == "bending-5mm" else 2
    for body in model.bodies:
        volume = BODIES.get(body.name, 2 * half * 50 * 10)
        assert body.volume == pytest.approx(volume, rel=1e-9)  # gmsh's own, exact for these
    if name.startswith("bending"):
        punch = model.points[model.bodies[1].triangles].reshape(-1, 3)
        middle = -20 if name == "bending-eccentric" else 0
        np.testing.assert_allclose(
            [punch.min(axis=0), punch.max(axis=0)],
            [[middle - half, 100, 0], [middle + half, 150, 10]],
            atol=1e-6,  # gmsh's tolerance of geometry
        )
