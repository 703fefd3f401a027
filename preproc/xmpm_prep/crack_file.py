"""Crack files: what doc/crack_file.md describes, with companions for ParaView and meshio."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from xmpm_prep.crack_front import Front
from xmpm_prep.crack_surface import Surface
from xmpm_prep.files import whole_files
from xmpm_prep.paraview import add_poly_data, companions, write_vtkhdf_link, write_xdmf


def write_crack(path, surface: Surface, fronts: list[Front], unit: str) -> None:
    """Write a crack file and its companions, all of them whole or none."""
    path = Path(path)
    with whole_files(path, *companions(path)) as (data, vtkhdf, xdmf):
        with h5py.File(data, "w") as file:
            file.attrs["format"] = "xmpm3d crack"
            file.attrs["version"] = 1
            file.attrs["length_unit"] = unit
            file["vertices"] = surface.points
            file["triangles"] = surface.triangles.astype(np.int64)
            edges = [front.edges for front in fronts]
            file["front_edges"] = np.concatenate([np.zeros((0, 2), np.int64), *edges])
            file["front_numbers"] = np.repeat(np.arange(len(edges)), [len(some) for some in edges])
            number = np.full(len(surface.points), -1)
            for i, front in enumerate(fronts):
                number[front.vertices] = i
            file["vertex_fronts"] = number
            lines = [
                [*front.vertices, front.vertices[0]] if front.closed else front.vertices
                for front in fronts
            ]
            add_poly_data(
                file,
                file["vertices"],
                lines=lines,
                polygons=surface.triangles,
                point_data={"front": file["vertex_fronts"]},
            )
            write_xdmf(
                xdmf, path, file, "Triangle", "triangles", "vertices", {"front": "vertex_fronts"}
            )
        write_vtkhdf_link(vtkhdf, path)
