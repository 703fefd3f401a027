"""Tables of the program: CSV files with provenance, units and one header line."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from xmpm_post.errors import PostError, names


@dataclass(frozen=True)
class Table:
    """Columns of a CSV file."""

    columns: dict[str, np.ndarray]  #: numbers, or text where a column holds any
    units: dict[str, str] = field(default_factory=dict)  #: unit of each column; 1 for a number
    provenance: dict[str, str] = field(default_factory=dict)  #: lines `# key: value` of the file
    source: str = "table"  #: where it came from, for messages

    def __getitem__(self, name: str) -> np.ndarray:
        """Column of a name."""
        if name not in self.columns:
            raise PostError(f"{self.source}: no column {name}; there are: {names(self.columns)}")
        return self.columns[name]

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def unit(self, name: str) -> str:
        """Unit of a column; empty where the file has none."""
        return self.units.get(name, "")

    def values(self, name: str) -> list:
        """Different values of a column, in the order in which they come."""
        return list(dict.fromkeys(self[name].tolist()))

    def where(self, **wanted: object) -> Table:
        """Rows with these values; a time takes the nearest one that the table has."""
        kept = np.ones(len(self), bool)
        for name, value in wanted.items():
            column = self[name]
            if len(column) == 0:
                raise PostError(f"{self.source}: no rows")
            if name == "time":
                value = column[np.argmin(np.abs(column - float(value)))]
            if not np.any(column == value):
                there = names(
                    f"{v:g}" if isinstance(v, float) else v for v in self.values(name)[:20]
                )
                raise PostError(f"{self.source}: no {name} {value}; there are: {there}")
            kept &= column == value
        return self.keep(kept)

    def keep(self, rows: np.ndarray) -> Table:
        """Rows of a mask or of numbers."""
        columns = {name: column[rows] for name, column in self.columns.items()}
        return Table(columns, self.units, self.provenance, self.source)


def read_table(path: Path) -> Table:
    """Table of a file."""
    if not path.is_file():
        raise PostError(f"{path}: no such file")
    comments, lines = [], []
    with path.open(newline="") as file:
        for line in csv.reader(file):
            if line and line[0].startswith("#"):
                comments.append(",".join(line)[1:].strip())
            elif line:
                lines.append([entry.strip() for entry in line])
    if not lines:
        raise PostError(f"{path}: the file is empty")
    header, rows = lines[0], lines[1:]
    if rows and len(rows[-1]) < len(header):
        rows.pop()  # a run that was killed, or one that is being written
    for number, row in enumerate(rows, 1):
        if len(row) != len(header):
            raise PostError(f"{path}: row {number} has {len(row)} values, not {len(header)}")
    columns = zip(*rows, strict=True) if rows else [()] * len(header)
    said = dict(c.split(":", 1) for c in comments if ":" in c)
    said = {key.strip(): value.strip() for key, value in said.items()}
    units = [unit.strip() for unit in said.pop("units", "").split(",")]
    return Table(
        {name: as_array(column) for name, column in zip(header, columns, strict=True)},
        dict(zip(header, units, strict=False)),
        said,
        path.name,
    )


def as_array(column: tuple[str, ...]) -> np.ndarray:
    """Numbers where all entries are numbers, else text."""
    try:
        return np.array([float(entry) for entry in column])
    except ValueError:
        return np.array(column)
