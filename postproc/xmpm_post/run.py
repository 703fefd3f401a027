"""A run's files behind one object."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from xmpm_post.errors import PostError, names
from xmpm_post.table import Table, read_table
from xmpm_post.vtkhdf import PolyData, read_step, read_times

ENDS = (
    "_energy.csv", "_front.csv", "_probe.csv", "_particles.vtkhdf", "_crack.vtkhdf", ".log",
)  # fmt: skip


@dataclass(frozen=True)
class Run:
    """Files of a run, read when asked for."""

    folder: Path
    name: str  #: of the deck's *JOB, which heads all files

    def path(self, end: str) -> Path:
        """File of the run by the end of its name, such as `_front.csv`."""
        return self.folder / f"{self.name}{end}"

    @cached_property
    def front(self) -> Table:
        """Fracture parameters: a row a front point and output time."""
        if not self.path("_front.csv").is_file():
            raise PostError(
                f"{self.path('_front.csv')}: no such file; the deck asks for it with *FRACTURE"
            )
        return read_table(self.path("_front.csv"))

    @cached_property
    def energy(self) -> Table:
        """Energies and momenta over time."""
        return read_table(self.path("_energy.csv"))

    @cached_property
    def probe(self) -> Table:
        """What the deck's *PROBE blocks ask for, over time."""
        return read_table(self.path("_probe.csv"))

    @cached_property
    def units(self) -> tuple[str, str]:
        """Units of length and time; empty where the run does not tell."""
        try:
            words = self.energy.provenance.get("unit_system", "").split()
        except PostError:
            words = []
        return (words[0], words[2]) if len(words) == 3 else ("", "")

    def particles(self, time: float | None = None) -> PolyData:
        """Particles of the step nearest to a time, or of the last step."""
        return read_step(self.path("_particles.vtkhdf"), time)

    def crack(self, time: float | None = None) -> PolyData:
        """Surfaces and fronts of the step nearest to a time, or of the last step."""
        return read_step(self.path("_crack.vtkhdf"), time)

    def times(self, what: str = "particles") -> np.ndarray:
        """Times at which particles, or the crack, were written."""
        return read_times(self.path(f"_{what}.vtkhdf"))


def open_run(path: str | Path) -> Run:
    """Run of a path: folder/NAME, one of its files, or a folder with one run in it."""
    path = Path(path)
    if path.is_dir():
        return only_run(path)
    for end in ENDS:
        if path.is_file() and path.name.endswith(end):
            return Run(path.parent, path.name.removesuffix(end))
    if any(path.with_name(path.name + end).is_file() for end in ENDS):
        return Run(path.parent, path.name)
    if not path.parent.is_dir():
        raise PostError(f"{path.parent}: no such folder")
    there = runs_of(path.parent)
    raise PostError(f"{path}: no such run; in {path.parent} there are: {names(there)}")


def runs_of(folder: Path) -> list[str]:
    """Names of the runs in a folder."""
    found = set()
    for end in ENDS:
        found |= {file.name.removesuffix(end) for file in folder.glob(f"*{end}")}
    return sorted(found)


def only_run(folder: Path) -> Run:
    """The run of a folder that has just one."""
    there = runs_of(folder)
    if len(there) != 1:
        raise PostError(f"{folder}: name one run as {folder}/NAME; there are: {names(there)}")
    return Run(folder, there[0])
