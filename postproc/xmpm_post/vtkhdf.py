"""Point data of one time out of a VTKHDF file (PolyData), with or without steps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np

from xmpm_post.errors import PostError, names

KINDS = ("Vertices", "Lines", "Polygons", "Strips")  # columns of CellOffsets


@dataclass(frozen=True)
class PolyData:
    """Particles, or the surfaces and fronts of the cracks, at one time."""

    time: float
    points: np.ndarray  #: (n,3) positions
    fields: dict[str, np.ndarray]  #: (n,) or (n,k) values at the points, by name
    units: dict[str, str]  #: unit of each field
    lines: list[np.ndarray]  #: point numbers of each front; a closed one ends where it began
    triangles: np.ndarray  #: (m,3) point numbers
    source: str  #: name of the file, for messages

    def field(self, name: str) -> np.ndarray:
        """Values of a field."""
        if name not in self.fields:
            raise PostError(f"{self.source}: no field {name}; there are: {names(self.fields)}")
        return self.fields[name]


def read_times(path: Path) -> np.ndarray:
    """Times of a file's steps; one of 0 where it has none."""
    with open_file(path) as file:
        root = file["VTKHDF"]
        if "Steps" not in root:
            return np.zeros(1)
        return np.array(root["Steps/Values"][: int(root["Steps"].attrs["NSteps"])], float)


def read_step(path: Path, time: float | None = None) -> PolyData:
    """Poly data of the step nearest to a time, or of the last one."""
    times = read_times(path)
    if len(times) == 0:
        raise PostError(f"{path}: no steps")
    step = len(times) - 1 if time is None else int(np.argmin(np.abs(times - time)))
    with open_file(path) as file:
        root = file["VTKHDF"]
        at, parts = offsets(root, step)
        last = at["points"] + sum(int(root["NumberOfPoints"][p]) for p in parts)
        fields, units = {}, {}
        for name, data in root.get("PointData", {}).items():
            start = at["fields"].get(name, at["points"])
            fields[name] = np.array(data[start : start + last - at["points"]], float)
            unit = data.attrs.get("unit", b"")
            units[name] = unit.decode() if isinstance(unit, bytes) else str(unit)
        lines = read_cells(root, "Lines", at, parts)
        faces = [c for c in read_cells(root, "Polygons", at, parts) if len(c) == 3]
        points = np.array(root["Points"][at["points"] : last], float)
    triangles = np.array(faces, int).reshape(-1, 3)
    return PolyData(float(times[step]), points, fields, units, lines, triangles, path.name)


def open_file(path: Path) -> h5py.File:
    """An HDF5 file with the group VTKHDF."""
    if not path.is_file():
        raise PostError(f"{path}: no such file")
    try:
        file = h5py.File(path, "r")
    except OSError as fault:
        raise PostError(f"{path}: not an HDF5 file") from fault
    if "VTKHDF" not in file:
        file.close()
        raise PostError(f"{path}: no group VTKHDF in it")
    return file


def offsets(root: h5py.Group, step: int) -> tuple[dict, range]:
    """Where the data of a step begin, and its parts."""
    if "Steps" not in root:
        zeros = [0] * len(KINDS)
        return {"points": 0, "cells": zeros, "ids": zeros, "fields": {}}, range(
            len(root["NumberOfPoints"])
        )
    steps = root["Steps"]
    first = int(steps["PartOffsets"][step])
    at = {
        "points": int(steps["PointOffsets"][step]),
        "cells": [int(v) for v in np.atleast_1d(steps["CellOffsets"][step])],
        "ids": [int(v) for v in np.atleast_1d(steps["ConnectivityIdOffsets"][step])],
        "fields": {n: int(d[step]) for n, d in steps.get("PointDataOffsets", {}).items()},
    }
    return at, range(first, first + int(steps["NumberOfParts"][step]))


def read_cells(root: h5py.Group, kind: str, at: dict, parts: range) -> list[np.ndarray]:
    """Point numbers of each cell of a kind, parts joined."""
    column = KINDS.index(kind)
    first_cell, first_id, base = at["cells"][column], at["ids"][column], 0
    group, cells = root[kind], []
    for part in parts:
        count = int(group["NumberOfCells"][part])
        size = int(group["NumberOfConnectivityIds"][part])
        # A part has one offset more than cells, so the parts before shift its place.
        start = first_cell + part
        ends = np.array(group["Offsets"][start : start + count + 1], int)
        ids = np.array(group["Connectivity"][first_id : first_id + size], int) + base
        cells += [ids[a:b] for a, b in pairwise(ends)]
        first_cell, first_id = first_cell + count, first_id + size
        base += int(root["NumberOfPoints"][part])
    return cells
