"""xmpm-prep crack: shapes, files, repair, fronts, and one clear line for everything broken."""

import h5py
import meshio
import numpy as np
import pytest
import pyvista

from xmpm_prep.cli import main
from xmpm_prep.crack_intersect import check_intersection
from xmpm_prep.crack_make import Wish, make_crack
from xmpm_prep.crack_remesh import remesh
from xmpm_prep.crack_shapes import Shape
from xmpm_prep.crack_surface import Surface, check_manifold, orient
from xmpm_prep.errors import PrepError
from xmpm_prep.gmsh_session import gmsh_session


def half_cylinder(n=16, layers=6, radius=10.0, height=8.0):
    """A half-cylinder of triangles with outward normals, and the length of its rim."""
    angle = np.linspace(0.0, np.pi, n + 1)
    z = np.linspace(0.0, height, layers + 1)
    points = np.array([(radius * np.cos(a), radius * np.sin(a), c) for c in z for a in angle])
    triangles = []
    for j in range(layers):
        for i in range(n):
            a = j * (n + 1) + i
            b, c, d = a + 1, a + n + 2, a + n + 1
            triangles += [(a, b, c), (a, c, d)]
    rim = 2 * n * 2 * radius * np.sin(np.pi / (2 * n)) + 2 * height
    return Surface(points, np.array(triangles)), rim


def write_stl(path, surface, binary=False):
    meshio.write(
        path, meshio.Mesh(surface.points, [("triangle", surface.triangles)]), binary=binary
    )


def block_of_particles(path, low, high, edge=0.5, unit="mm"):
    """A particle file of a box."""
    axes = [np.arange(a + edge / 2, b, edge) for a, b in zip(low, high, strict=True)]
    positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "xmpm3d particles"
        file.attrs["version"] = 1
        file.attrs["length_unit"] = unit
        file["positions"] = positions
        file["volumes"] = np.full(len(positions), edge**3)
    return path


# --- shapes -----------------------------------------------------------------------------------

ELLIPSE = 176.08  # circumference with semi-axes 20 and 35, by Ramanujan's second formula

SHAPES = [
    (Shape("disc", radius=(10.0,)), 62.832, 314.16, (0, 0, 1)),
    (Shape("disc", along=(0, 1, 0), across=(0, 0, 1), radius=(10.0,)), 62.832, 314.16, (1, 0, 0)),
    (Shape("ellipse", semi_axes=(20.0, 35.0)), ELLIPSE, 2199.1, (0, 0, 1)),
    (Shape("sector", semi_axes=(20.0, 35.0), angles=(0, 90)), ELLIPSE / 4 + 55, 549.78, (0, 0, 1)),
    (Shape("sector", radius=(10.0,), angles=(-100, 200)), 20 + 52.360, 261.80, (0, 0, 1)),
    (Shape("plane", width=20.0, depth=10.0), 60.0, 200.0, (0, 0, 1)),
    (Shape("cylinder", radius=(10.0,), height=8.0, angles=(0, 90)), 47.416, 125.66, (1, 1, 0)),
    (Shape("cylinder", radius=(10.0,), height=8.0), 125.66, 502.65, None),
    (
        Shape("cone", radius=(10.0, 4.0), height=8.0, angles=(0, 90)),
        41.991,
        219.91 / 2,
        (1, 1, 1.06),
    ),
    (Shape("cone", radius=(10.0, 0.0), height=10.0), 62.832, 444.29, (0, 0, 1)),
]


@pytest.mark.parametrize(("shape", "rim", "area", "normal"), SHAPES)
def test_a_shape_has_its_length_area_and_normal(shape, rim, area, normal):
    size = 2.0
    crack = make_crack(Wish(shape, size, size))
    # Chords of length 2 on a radius of 4 (cone) or more: short by (2 / 4)**2 / 24 = 1 %.
    assert sum(front.length for front in crack.fronts) == pytest.approx(rim, rel=0.01)
    assert crack.surface.areas.sum() == pytest.approx(area, rel=0.02)
    total = crack.surface.area_vectors.sum(axis=0)
    if normal is None:
        assert np.linalg.norm(total) < 1e-6 * area  # a closed ring
    else:
        direction = np.array(normal) / np.linalg.norm(normal)
        assert total @ direction == pytest.approx(np.linalg.norm(total), rel=1e-2)
    assert crack.surface.angles.min() > 25.0
    # 0.5 and 1.7 are what gmsh's frontal method keeps to on smooth shapes.
    lengths = crack.surface.edge_lengths()
    assert 0.5 * size < lengths.min()
    assert lengths.max() < 1.7 * size


def test_vertices_of_a_disc_lie_on_its_rim():
    crack = make_crack(Wish(Shape("disc", centre=(3, 4, 5), radius=(10.0,)), 2.0, 2.0))
    (front,) = crack.fronts
    assert front.closed
    radius = np.linalg.norm(crack.surface.points[front.vertices] - [3, 4, 5], axis=1)
    np.testing.assert_allclose(radius, 10.0, rtol=1e-9)  # gmsh's geometry is good to 1e-7


# --- files ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The same half-cylinder in every format."""
    folder = tmp_path_factory.mktemp("formats")
    surface, rim = half_cylinder()
    mesh = meshio.Mesh(surface.points, [("triangle", surface.triangles)])
    write_stl(folder / "ascii.stl", surface)
    write_stl(folder / "binary.stl", surface, binary=True)
    mesh.write(folder / "a.off")
    mesh.write(folder / "grid.vtk", file_format="vtk42")
    mesh.write(folder / "a.vtu")
    faces = np.column_stack([np.full(len(surface.triangles), 3), surface.triangles])
    pyvista.PolyData(surface.points, faces.ravel()).save(folder / "poly.vtk")
    pyvista.PolyData(surface.points, faces.ravel()).save(folder / "a.vtp")
    with gmsh_session() as gmsh:
        tag = gmsh.model.addDiscreteEntity(2)
        gmsh.model.mesh.addNodes(
            2, tag, np.arange(1, len(surface.points) + 1), surface.points.ravel()
        )
        gmsh.model.mesh.addElementsByType(tag, 2, [], surface.triangles.ravel() + 1)
        gmsh.model.addPhysicalGroup(2, [tag], name="flaw")
        for version in (2.2, 4.1):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.write(str(folder / f"v{version}.msh"))
    return folder, surface, rim


FORMATS = "ascii.stl binary.stl a.off grid.vtk poly.vtk a.vtu a.vtp v2.2.msh v4.1.msh".split()


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_crack(files, name):
    folder, surface, rim = files
    crack = make_crack(Wish(folder / name, 2.0, 2.0, keep=True))
    assert len(crack.surface.points) == len(surface.points)
    assert len(crack.surface.triangles) == len(surface.triangles)
    # Binary STL and VTK files may hold single precision.
    np.testing.assert_allclose(
        crack.surface.area_vectors.sum(axis=0), surface.area_vectors.sum(axis=0), atol=1e-4
    )
    (front,) = crack.fronts
    assert front.closed
    assert front.length == pytest.approx(rim, rel=1e-6)


def test_physical_surfaces_are_chosen_by_name(files):
    folder, _, _ = files
    crack = make_crack(Wish(folder / "v4.1.msh", 2.0, 2.0, name="flaw", keep=True))
    assert len(crack.fronts) == 1
    with pytest.raises(PrepError, match=r"no physical surface 'claw'; .*: flaw"):
        make_crack(Wish(folder / "v4.1.msh", 2.0, 2.0, name="claw"))


def test_a_geometry_file_is_meshed_on_its_curves(tmp_path):
    path = tmp_path / "penny.geo"
    path.write_text(
        'SetFactory("OpenCASCADE");\nBox(1) = {-20, -20, -20, 40, 40, 40};\n'
        'Disk(100) = {0, 0, 0, 8};\nPhysical Surface("penny") = {100};\n'
        'Physical Volume("block") = {1};\nMesh.CharacteristicLengthMax = 0.1;\n'
    )
    wish = Wish(path, 1.0, 1.0, body=block_of_particles(tmp_path / "b.h5", [-20] * 3, [20] * 3))
    crack = make_crack(wish)
    (front,) = crack.fronts
    assert front.length == pytest.approx(16 * np.pi, rel=1e-3)  # chords: 1 / 8**2 / 24
    assert len(front.edges) == pytest.approx(16 * np.pi, abs=3)


def test_a_surface_of_a_step_file_is_taken_and_the_body_of_an_stl(tmp_path):
    with gmsh_session() as gmsh:
        gmsh.model.occ.addDisk(0, 0, 0, 12, 4)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "disk.step"))
        gmsh.model.occ.remove(gmsh.model.occ.getEntities(2))
        gmsh.model.occ.addSphere(0, 0, 0, 7)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 1.0)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(tmp_path / "ball.stl"))
    crack = make_crack(Wish(tmp_path / "disk.step", 1.0, 1.0, body=tmp_path / "ball.stl"))
    # The disk reaches out of the ball at both ends of its longer axis: two fronts, between the
    # points where its ellipse meets the circle of radius 7.
    assert len(crack.fronts) == 2
    t = np.arcsin(np.sqrt((12**2 - 7**2) / (12**2 - 4**2)))
    angle = t + (np.arange(1000) + 0.5) / 1000 * (np.pi - 2 * t)
    length = np.hypot(12 * np.sin(angle), 4 * np.cos(angle)).mean() * (np.pi - 2 * t)
    for front in crack.fronts:
        # The ball's triangles lie up to 1 / (8 * 7) inside, where the rim meets it at 49 degrees;
        # an edge is measured in 200 parts; chords fall short by (1 / 8)**2 / 24.
        assert front.length == pytest.approx(length, abs=0.06)


# --- repair and meshing ---------------------------------------------------------------------------


def test_orientation_is_repaired_to_the_larger_side(tmp_path):
    surface, _ = half_cylinder()
    rng = np.random.default_rng(3)
    wrong = rng.random(len(surface.triangles)) < 0.3
    triangles = surface.triangles.copy()
    triangles[wrong] = triangles[wrong][:, ::-1]
    mended, turned = orient(Surface(surface.points, triangles))
    assert turned == wrong.sum()
    np.testing.assert_array_equal(mended.area_vectors, surface.area_vectors)


def test_two_parts_are_oriented_each_for_itself():
    surface, _ = half_cylinder()
    n = len(surface.points)
    points = np.concatenate([surface.points, surface.points + np.array([0, 0, 50])])
    triangles = np.concatenate([surface.triangles, surface.triangles[:, ::-1] + n])
    mended, turned = orient(Surface(points, triangles))
    assert turned == 0
    np.testing.assert_array_equal(mended.triangles, triangles)


def test_faulty_triangles_are_left_out_and_named(tmp_path):
    surface, rim = half_cylinder()
    extra = [[0, 0, 1], surface.triangles[5][[1, 2, 0]], surface.triangles[7][::-1]]
    path = tmp_path / "faulty.off"
    meshio.Mesh(surface.points, [("triangle", np.concatenate([surface.triangles, extra]))]).write(
        path
    )
    crack = make_crack(Wish(path, 2.0, 2.0, keep=True))
    assert crack.fronts[0].length == pytest.approx(rim, rel=1e-12)
    assert "1 degenerate" in crack.notes[0]
    assert "2 duplicate" in crack.notes[1]


@pytest.mark.parametrize("size", [1.2, 2.0, 3.5])
def test_triangles_of_a_file_are_meshed_anew_with_a_good_angle(size):
    surface, rim = half_cylinder()
    made = remesh(surface, size)
    check_manifold(made)
    check_intersection(made)
    assert made.angles.min() > 25.0
    lengths = made.edge_lengths()
    assert lengths.mean() == pytest.approx(size, rel=0.25)
    assert lengths.max() < 1.4 * size  # longer ones are split
    ends = made.points[made.edges.half[made.edges.free()]]
    rim_length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    # Chords of up to 3.5 over the polygon of the file, on a radius of 10: (3.5 / 10)**2 / 24.
    assert rim_length == pytest.approx(rim, rel=0.006)
    assert made.areas.sum() == pytest.approx(surface.areas.sum(), rel=0.01)
    # No vertex leaves the triangles of the file: between the inscribed radius and the radius.
    radius = np.hypot(made.points[:, 0], made.points[:, 1])
    assert radius.max() < 10.0 + 1e-9
    assert radius.min() > 10.0 * np.cos(np.pi / 32) - 1e-9


def test_meshing_anew_keeps_sharp_edges_and_corners():
    x, y = np.meshgrid([0.0, 5.0, 10.0], [0.0, 5.0, 10.0], indexing="ij")
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(9)])
    up = flat[:, [2, 1, 0]] + [10.0, 0.0, 0.0]  # a roof with its ridge at x = 10, z = 0
    cells = [(0, 3, 4), (0, 4, 1), (1, 4, 5), (1, 5, 2), (3, 6, 7), (3, 7, 4), (4, 7, 8), (4, 8, 5)]
    triangles = np.concatenate([np.array(cells), np.array(cells) + 9])
    joined = {9: 6, 10: 7, 11: 8}  # the ridge has each vertex once
    triangles = np.vectorize(lambda v: joined.get(v, v))(triangles)
    surface, _ = orient(Surface(np.concatenate([flat, up]), triangles))
    made = remesh(surface, 1.3)
    assert made.areas.sum() == pytest.approx(200.0, rel=1e-9)  # planes and straight rims stay
    for corner in ([0, 0, 0], [10, 0, 0], [10, 10, 0], [10, 10, 10], [10, 0, 10]):
        assert np.linalg.norm(made.points - corner, axis=1).min() < 1e-12


# --- fronts ---------------------------------------------------------------------------------------


def test_edges_outside_the_body_are_no_front(tmp_path):
    body = block_of_particles(tmp_path / "body.h5", [-20, -10, -5], [20, 10, 5])
    shape = Shape("plane", along=(1, 0, 0), across=(0, 0, 1), width=16.0, depth=16.0)
    crack = make_crack(Wish(shape, 1.0, 1.0, body=body))
    assert len(crack.fronts) == 2
    for front in crack.fronts:
        assert not front.closed
        # At each end 1 / 200 of an edge of 1, and 1 % of a particle's cube of 0.5.
        assert front.length == pytest.approx(10.0, abs=0.02)
        assert np.ptp(crack.surface.points[front.vertices][:, 0]) < 1e-9
    assert crack.unit == "mm"


def test_a_surface_that_ends_on_the_boundary_gets_a_strip_outside(tmp_path):
    body = block_of_particles(tmp_path / "body.h5", [-20, -10, -5], [20, 10, 5])
    shape = Shape("plane", along=(1, 0, 0), across=(0, 0, 1), width=16.0, depth=10.0)
    crack = make_crack(Wish(shape, 1.0, 1.0, body=body))
    low, high = crack.surface.points.min(axis=0), crack.surface.points.max(axis=0)
    # 1.5 cells beyond z = -5 and 5; along the front, so that x stays as it is.
    np.testing.assert_allclose([low[0], high[0]], [-8.0, 8.0], atol=1e-9)
    np.testing.assert_allclose([low[2], high[2]], [-6.5, 6.5], atol=1e-9)
    assert [front.length for front in crack.fronts] == pytest.approx([10.0, 10.0], abs=0.02)
    assert crack.surface.angles.min() > 20.0
    plain = make_crack(Wish(shape, 1.0, 1.0, body=body, strip=0.0))
    assert np.ptp(plain.surface.points[:, 2]) == pytest.approx(10.0)
    assert any("on the boundary" in note for note in plain.notes)


def test_edges_that_the_program_would_take_for_fronts_are_told(tmp_path, capsys):
    # Cells of 2 hold material up to z = 6; the crack ends at 5.2, 0.2 outside, plus 0.6 ahead.
    body = block_of_particles(tmp_path / "body.h5", [-20, -10, -5], [20, 10, 5])
    shape = Shape("plane", along=(1, 0, 0), across=(0, 0, 1), width=16.0, depth=10.4)
    wish = Wish(shape, 1.0, 2.0, body=body, strip=0.0)
    crack = make_crack(wish)
    assert "will be taken for fronts" in crack.notes[-1]
    assert "widen its --strip" in capsys.readouterr().err
    whole = make_crack(Wish(shape, 1.0, 2.0, body=body))
    assert not any("taken for fronts" in note for note in whole.notes)
    assert capsys.readouterr().err == ""


def test_a_crack_all_through_has_no_front(tmp_path):
    body = block_of_particles(tmp_path / "body.h5", [-5, -5, -5], [5, 5, 5])
    crack = make_crack(Wish(Shape("plane", width=14.0, depth=14.0), 1.0, 1.0, body=body))
    assert crack.fronts == []


def test_without_a_body_the_whole_rim_is_front():
    crack = make_crack(Wish(Shape("cylinder", radius=(10.0,), height=8.0), 2.0, 2.0))
    assert [front.closed for front in crack.fronts] == [True, True]


# --- the command ----------------------------------------------------------------------------------


def test_the_command_writes_a_crack_file_and_reports(tmp_path, capsys):
    path = tmp_path / "penny.h5"
    line = f"crack disc --radius 10 --size 2 --unit mm -o {path}"
    assert main(line.split()) == 0
    said = capsys.readouterr().out
    for word in ("triangles", "area", "angles", "front 1", "closed", "mm"):
        assert word in said
    with h5py.File(path) as file:
        assert file.attrs["format"] == "xmpm3d crack"
        assert file.attrs["version"] == 1
        assert file.attrs["length_unit"] == "mm"
        points, triangles = file["vertices"][:], file["triangles"][:]
        assert Surface(points, triangles).areas.sum() == pytest.approx(100 * np.pi, rel=0.02)
        # Edges of the rim are as long as their chords.
        edges = points[file["front_edges"][:]]
        assert np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum() == pytest.approx(
            20 * np.pi, rel=0.01
        )
    # ParaView's companion and meshio's show the same triangles.
    seen = pyvista.read(tmp_path / "penny.vtkhdf")
    assert seen.n_points == len(points)
    mesh = meshio.read(tmp_path / "penny.xdmf")
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], triangles)
    # What was written can be read again, as it is.
    again = make_crack(Wish(path, 2.0, 2.0, keep=True))
    np.testing.assert_array_equal(again.surface.points, points)


def test_turn_exchanges_the_sides(tmp_path):
    shape = Shape("disc", radius=(10.0,))
    plus, minus = (make_crack(Wish(shape, 2.0, 2.0, turn=turn)) for turn in (False, True))
    np.testing.assert_allclose(
        plus.surface.area_vectors.sum(axis=0), -minus.surface.area_vectors.sum(axis=0), atol=1e-9
    )


# --- broken input ---------------------------------------------------------------------------------


def moebius(n=24):
    """A strip with one side."""
    rows = []
    for i in range(n):
        u = 2 * np.pi * i / n
        for v in (-1.0, 1.0):
            r = 6 + v * np.cos(u / 2)
            rows.append((r * np.cos(u), r * np.sin(u), v * np.sin(u / 2)))
    triangles = []
    for i in range(n):
        a, b = 2 * i, 2 * i + 1
        c, d = (a + 2, b + 2) if i < n - 1 else (1, 0)
        triangles += [(a, c, b), (b, c, d)]
    return np.array(rows), np.array(triangles)


SQUARE = np.array([(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0)], float)
HALVES = np.array([(0, 1, 2), (0, 2, 3)])


def broken(name):
    """Points and triangles of a broken surface."""
    if name == "branch":
        return np.concatenate([SQUARE, [[2.0, 2.0, 3.0]]]), np.concatenate([HALVES, [[0, 2, 4]]])
    if name == "vertex":
        points = np.concatenate([SQUARE, [[6.0, 4.0, 0.0], [6.0, 6.0, 0.0]]])
        return points, np.concatenate([HALVES, [[2, 4, 5]]])
    if name == "cross":
        upright = np.array([(2, -1, -2), (2, 5, -2), (2, 2, 4)], float)
        return np.concatenate([SQUARE, upright]), np.concatenate([HALVES, [[4, 5, 6]]])
    if name == "overlap":
        return np.concatenate([SQUARE, SQUARE + np.array([1, 1, 0])]), np.concatenate(
            [HALVES, HALVES + 4]
        )
    if name == "fold":
        return np.concatenate([SQUARE, [[1.0, 2.0, 0.0]]]), np.concatenate([HALVES, [[2, 1, 4]]])
    if name == "hanging":
        points = np.concatenate([SQUARE, [[2.0, 0.0, 0.0], [2.0, -3.0, 0.0], [4.0, -3.0, 0.0]]])
        return points, np.concatenate([HALVES, [[4, 5, 6]]])
    return moebius()


BROKEN = [
    ("branch", "not manifold: 3 triangles"),
    ("vertex", "touch only at the vertex"),
    ("cross", "intersects or touches itself"),
    ("overlap", "intersects or touches itself"),
    ("fold", "intersects or touches itself"),
    ("hanging", "intersects or touches itself"),
    ("moebius", "one side only"),
]


def expect_line(capsys, path, arguments, text, code=2):
    """The command ends with this code and one line, and leaves nothing behind."""
    before = sorted(path.iterdir())
    assert main(["crack", *map(str, arguments), "-o", str(path / "out.h5")]) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("xmpm-prep: ")
    assert text in line
    assert sorted(path.iterdir()) == before


@pytest.mark.parametrize(("name", "text"), BROKEN)
def test_a_broken_surface_gives_one_clear_line(tmp_path, capsys, name, text):
    points, triangles = broken(name)
    path = tmp_path / "broken.off"
    meshio.Mesh(points, [("triangle", triangles)]).write(path)
    expect_line(capsys, tmp_path, [path, "--size", 1], text)


def test_unreadable_files_give_one_clear_line(tmp_path, capsys):
    for name in ("a.stl", "a.off", "a.vtk", "a.msh", "a.geo", "a.h5", "a.xyz", "a.vtp"):
        (tmp_path / name).write_text("this is no mesh {\n")
        expect_line(capsys, tmp_path, [tmp_path / name, "--size", 1], f"{name}", 4)
    expect_line(capsys, tmp_path, [tmp_path / "none.stl", "--size", 1], "no such file", 4)
    expect_line(capsys, tmp_path, [tmp_path, "--size", 1], "it is a folder", 4)


def test_wrong_sizes_give_one_clear_line(tmp_path, capsys):
    disc = ["disc", "--radius", 10]
    expect_line(capsys, tmp_path, [*disc, "--size", 100], "mixed units?")
    expect_line(capsys, tmp_path, [*disc, "--size", 0.001], "mixed units?")
    expect_line(capsys, tmp_path, [*disc, "--size", 0], "must be positive")
    expect_line(capsys, tmp_path, ["disc", "--size", 1], "it needs one radius")
    expect_line(capsys, tmp_path, ["plane", "--width", 3, "--size", 1], "a width and a depth")
    expect_line(
        capsys, tmp_path, [*disc, "--size", 1, "--across", 1, 1, 0], "must be at right angles"
    )
    expect_line(
        capsys,
        tmp_path,
        ["sector", "--radius", 10, "--angles", 0, 8, "--size", 1],
        "the smallest angle is",
    )


def test_a_crack_that_does_not_fit_its_body_gives_one_clear_line(tmp_path, capsys):
    body = block_of_particles(tmp_path / "body.h5", [-20, -10, -5], [20, 10, 5])
    disc = ["disc", "--body", body, "--size", 1, "--radius"]
    expect_line(capsys, tmp_path, [*disc, 4, "--centre", 100, 0, 0], "lies outside the body")
    expect_line(capsys, tmp_path, [*disc, 4000, "--size", 100], "mixed units?")
    expect_line(capsys, tmp_path, [*disc, 4, "--unit", "m"], "mixed units")
    expect_line(capsys, tmp_path, [*disc, 2, "--h", 14], "shorter than a cell")
    expect_line(capsys, tmp_path, [*disc, 4, "--part", "wheel"], "there is no body 'wheel'")


def test_an_output_that_cannot_be_written_gives_one_clear_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    line = f"crack disc --radius 10 --size 2 -o {tmp_path}/file/out.h5"
    assert main(line.split()) == 4
    (said,) = capsys.readouterr().err.splitlines()
    assert "file" in said
