"""The files of the unit test `test_vtkhdf` open in VTK, PyVista and h5py as what was written."""

import os
import shutil
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyvista
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

COUNTS = [4, 7, 0, 2]  # particles of each step, as in test_vtkhdf.f90
TIMES = [0.0, 0.5, 1.0, 1.5]
LAUNCH = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
}


def unit_test(name):
    """Path of a unit test's program: in the build we run in, or else in the newest one."""
    here = Path.cwd().resolve()
    for folder in (here, *here.parents):
        for place in (folder / name, folder / "tests" / name):
            if place.is_file():
                return place
    root = Path(__file__).resolve().parents[2]
    built = sorted(root.glob(f"build/*/tests/{name}"), key=lambda path: path.stat().st_mtime)
    if not built:
        pytest.fail(f"{name} is not built; run tests/run.sh")
    return built[-1]


@pytest.fixture(scope="module", params=[1, 3])
def written(request, tmp_path_factory):
    """Folder and name of the series written by a number of ranks."""
    ranks = request.param
    folder = tmp_path_factory.mktemp(f"ranks{ranks}")
    command = ["mpirun", "-n", str(ranks), str(unit_test("test_vtkhdf"))]
    subprocess.run(command, cwd=folder, env=LAUNCH | os.environ, check=True, timeout=120)
    return folder / "results", f"series{ranks}"


def times_of(path):
    """Times that VTK offers for a file."""
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    keys = vtkStreamingDemandDrivenPipeline
    times = reader.GetOutputInformation(0).Get(keys.TIME_STEPS())
    return reader, list(times or [])


def at_time(reader, time):
    """Poly data of one time."""
    reader.UpdateTimeStep(time)
    return pyvista.wrap(reader.GetOutputDataObject(0))


def test_particles_are_a_time_series(written):
    folder, name = written
    reader, times = times_of(folder / f"{name}_particles.vtkhdf")
    assert times == TIMES
    for time, count in zip(times, COUNTS, strict=True):
        data = at_time(reader, time)
        assert isinstance(data, pyvista.PolyData)
        assert data.n_points == count
        assert data.GetNumberOfVerts() == (1 if count else 0)


def test_fields_stand_with_their_particles(written):
    folder, name = written
    reader, times = times_of(folder / f"{name}_particles.vtkhdf")
    for time, count in zip(times, COUNTS, strict=True):
        data = at_time(reader, time)
        ids = np.asarray(data["id"])
        assert sorted(ids) == list(range(count))
        assert np.array_equal(data.points, np.column_stack([ids, time + 0 * ids, -ids]))
        assert np.array_equal(data["displacement"], data.points)
        assert data["stress"].shape == (count, 6)
        assert np.array_equal(data["psi"], ids / 3)  # float64: the same division, bit for bit
        assert data["psi"].dtype == np.float64
        assert data["stress"].dtype == np.float32


def test_master_does_not_depend_on_the_working_folder(written, monkeypatch, tmp_path):
    folder, name = written
    copy = shutil.copytree(folder, tmp_path / "moved")
    monkeypatch.chdir("/")
    reader, times = times_of(copy / f"{name}_particles.vtkhdf")
    assert at_time(reader, times[1]).n_points == COUNTS[1]


def test_each_step_opens_alone(written):
    folder, name = written
    for number, count in enumerate(COUNTS):
        path = folder / f"{name}_particles" / f"{name}_particles_{number:06d}.vtkhdf"
        data = pyvista.read(path)
        assert data.n_points == count


def test_crack_has_triangles_and_fronts(written):
    folder, name = written
    reader, times = times_of(folder / f"{name}_crack.vtkhdf")
    assert times == [0.0, 1.0]
    data = at_time(reader, 0.0)
    assert (data.n_points, data.GetNumberOfPolys(), data.GetNumberOfLines()) == (4, 2, 1)
    data = at_time(reader, 1.0)
    assert (data.n_points, data.GetNumberOfPolys(), data.GetNumberOfLines()) == (5, 3, 2)
    lines = vtk_to_numpy(data.GetLines().GetConnectivityArray())
    polys = vtk_to_numpy(data.GetPolys().GetConnectivityArray())
    assert lines.tolist() == [1, 4, 2, 3, 0]
    assert polys.tolist() == [0, 1, 2, 0, 2, 3, 1, 4, 2]
    assert np.array_equal(data["opening"], 2 * data.points)


def test_numbers_of_values_and_steps_agree(written):
    """VTK crashes where there are more times than steps."""
    folder, name = written
    for path in folder.rglob("*.vtkhdf"):
        with h5py.File(path) as file:
            steps = file["VTKHDF/Steps"]
            assert steps.attrs["NSteps"] == len(steps["Values"])
            assert file["VTKHDF"].attrs["Version"].tolist() == [2, 2]
            assert file["VTKHDF"].attrs.get_id("Type").dtype == np.dtype("S8")
            assert file["provenance"].attrs["job"].decode() == name
            assert int(file["provenance"].attrs["ranks"]) == int(name.removeprefix("series"))
