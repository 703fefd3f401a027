"""The command line of xmpm-prep: one line for each error, files that are whole or not there."""

import os
import signal
import subprocess
import sys
import time

import h5py
import meshio
import numpy as np
import pytest
from vtkmodules.vtkIOHDF import vtkHDFReader

from xmpm_prep.cli import main
from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.files import input_file, whole_files
from xmpm_prep.gmsh_session import gmsh_session, open_in_gmsh
from xmpm_prep.paraview import add_poly_data, companions, write_vtkhdf_link, write_xdmf


def test_wrong_options_end_with_one_line(capsys):
    assert main(["no-such-command"]) == 2
    assert main(["--no-such-option"]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 2
    assert all(line.startswith("xmpm-prep: ") for line in errors)


def test_version_and_help_exit_well(capsys):
    for option in ("--version", "--help"):
        with pytest.raises(SystemExit) as end:
            main([option])
        assert end.value.code == 0
    assert "xmpm-prep" in capsys.readouterr().out


def test_files_appear_together(tmp_path):
    one, two = tmp_path / "new" / "a.txt", tmp_path / "new" / "b.txt"
    with whole_files(one, two) as (first, second):
        first.write_text("1")
        second.write_text("2")
        assert not one.exists()
        assert not two.exists()
    assert (one.read_text(), two.read_text()) == ("1", "2")
    assert sorted(one.parent.iterdir()) == [one, two]


def test_failure_leaves_old_files_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(PrepError), whole_files(path, tmp_path / "b.txt") as (first, _):
        first.write_text("half")
        raise PrepError("no")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_paths_that_are_no_files_are_named(tmp_path):
    for path, reason in ((tmp_path / "x.geo", "no such file"), (tmp_path, "a folder")):
        with pytest.raises(PrepError, match=reason) as failure:
            input_file(path)
        assert failure.value.code == FILES


def test_gmsh_says_why_it_cannot_read(tmp_path):
    path = tmp_path / "bad.geo"
    path.write_text("Point(1) = {0, 0\n")
    with pytest.raises(PrepError, match=r"bad\.geo: gmsh cannot read it"), gmsh_session() as gmsh:
        open_in_gmsh(gmsh, path)
    with gmsh_session() as gmsh:  # a session after a failed one works
        assert gmsh.model.getEntities() == []


def test_companions_open_in_vtk_and_meshio_without_a_copy(tmp_path):
    path = tmp_path / "a.h5"
    link, description = companions(path)
    points = np.random.default_rng(1).random((10, 3))
    with whole_files(path, link, description) as (data, second, third):
        with h5py.File(data, "w") as file:
            file["positions"] = points
            file["volumes"] = np.arange(10.0)
            file["vertices"] = np.arange(10)[:, None]
            add_poly_data(
                file, file["positions"], [range(10)], point_data={"volumes": file["volumes"]}
            )
            write_xdmf(
                third,
                path,
                file,
                "Polyvertex",
                "vertices",
                "positions",
                {"volumes": "volumes"},
                ["a < b"],
            )
        write_vtkhdf_link(second, path)
    mesh = meshio.read(description)
    assert np.array_equal(mesh.points, points)
    assert np.array_equal(mesh.point_data["volumes"], np.arange(10.0))
    assert mesh.cells_dict["vertex"].shape == (10, 1)
    assert mesh.field_data["a < b"].tolist() == [0, 3]
    for name in (path, link):
        reader = vtkHDFReader()
        reader.SetFileName(str(name))
        reader.Update()
        result = reader.GetOutputDataObject(0)
        assert result.GetNumberOfPoints() == 10
        assert result.GetPointData().GetArray("volumes").GetValue(7) == 7
    assert link.stat().st_size < 10_000  # a link, no copy


def test_stopped_command_leaves_nothing(tmp_path, monkeypatch, capsys):
    from xmpm_prep.commands import deck

    def stopped(options):
        with whole_files(tmp_path / "a.txt") as (path,):
            path.write_text("half")
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(5)

    monkeypatch.setattr(deck, "run", stopped)
    assert main(["deck", "x.h5"]) == 130
    assert capsys.readouterr().err == "xmpm-prep: stopped\n"
    assert list(tmp_path.iterdir()) == []


def test_package_runs_as_a_module():
    end = subprocess.run(
        [sys.executable, "-m", "xmpm_prep", "--version"],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        timeout=60,
    )
    assert end.returncode == 0
    assert end.stdout.startswith("xmpm-prep ")
