"""Run the program on a deck and measure what it costs: CPU seconds, memory, results."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]


class RunError(Exception):
    """The program failed, or left no result that was asked for."""


@dataclass(frozen=True)
class Run:
    """A finished run of the program."""

    folder: Path  #: where its files are
    name: str  #: the deck's job name, which heads all files
    ranks: int  #: number of ranks
    cpu_s: float  #: user and system time of all ranks and of mpirun [s]
    wall_s: float  #: elapsed time [s]
    peak_bytes: int  #: largest resident size of any one rank [B]
    code: int  #: exit code
    text: str  #: standard output and standard error

    def table(self, what: str) -> dict[str, np.ndarray]:
        """Columns of NAME_what.csv, numbers as arrays, other columns as arrays of text."""
        path = self.folder / f"{self.name}_{what}.csv"
        if not path.is_file():
            raise RunError(f"{path} was not written")
        return read_table(path)


def read_table(path: Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file with a header line; lines that begin with # are skipped."""
    with path.open(newline="") as file:
        lines = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
    if not lines:
        raise RunError(f"{path} is empty")
    columns = zip(*lines[1:], strict=True) if len(lines) > 1 else [()] * len(lines[0])
    return {name.strip(): as_array(c) for name, c in zip(lines[0], columns, strict=True)}


def as_array(column: tuple[str, ...]) -> np.ndarray:
    """Numbers where all entries are numbers, else text."""
    try:
        return np.array([float(entry) for entry in column])
    except ValueError:
        return np.array([entry.strip() for entry in column])


def fill(template: str, **values: object) -> str:
    """Put values into a deck's places @name@; reals keep all their digits.

    A place without a value and a value without a place are errors.
    """
    places = set(re.findall(r"@(\w+)@", template))
    if places != set(values):
        raise KeyError(f"places {sorted(places)} do not match values {sorted(values)}")
    return re.sub(r"@(\w+)@", lambda m: as_text(values[m[1]]), template)


def as_text(value: object) -> str:
    """A value as the deck reads it; lists are separated by blanks."""
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple, np.ndarray)):
        return " ".join(as_text(v) for v in value)
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def job_name(deck: str) -> str:
    """Name after *JOB, which heads the names of all output files."""
    found = re.search(r"^\s*\*JOB\s+[\"']?([^\s\"',!$]+)", deck, re.I | re.M)
    if not found:
        raise ValueError("the deck has no *JOB")
    return found[1]


def run_deck(
    deck: str,
    *,
    ranks: int = 1,
    folder: Path | None = None,
    options: tuple[str, ...] = (),
    program: Path | None = None,
    before: tuple[str, ...] = (),
    limit_s: float = 3600.0,
    check: bool = True,
) -> Run:
    """Run a deck as a user does: `mpirun -n RANKS xmpm3d < deck`.

    The program is that of the environment variable XMPM3D unless given. Files go to `folder`, by
    default a new one under build/runs. `before` stands between mpirun and the program, for a
    profiler. A failure raises RunError with the end of the program's output unless `check` is off.
    """
    name = job_name(deck)
    if folder is None:
        parent = ROOT / "build" / "runs"
        parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{name}-", dir=parent))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.inp").write_text(deck)
    program = Path(program or os.environ["XMPM3D"])
    command = ["mpirun", "-n", str(ranks), *before, str(program), "-o", str(folder), *options]
    code, cpu, wall, peak, text = run_command(command, folder, folder / "deck.inp", limit_s)
    if check and code != 0:
        raise RunError(f"{name}: exit code {code} ({folder})\n{text[-2000:]}")
    return Run(folder, name, ranks, cpu, wall, peak, code, text)


def run_command(
    command: list[str], folder: Path, stdin: Path | None, limit_s: float
) -> tuple[int, float, float, int, str]:
    """Exit code, CPU seconds, wall seconds, peak resident bytes and output of a command.

    CPU time is that of the process and of all its descendants that were waited for, and the peak
    is the largest of them, so both see through mpirun.
    """
    output = folder / "output.txt"
    started = time.monotonic()
    with output.open("wb") as out, open(stdin or os.devnull, "rb") as given:  # noqa: PTH123
        process = subprocess.Popen(
            command, cwd=folder, stdin=given, stdout=out, stderr=subprocess.STDOUT
        )
        clock = threading.Timer(limit_s, process.terminate)
        clock.start()
        try:
            _, status, usage = os.wait4(process.pid, 0)
        finally:
            clock.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.monotonic() - started
    text = output.read_text(errors="replace")
    cpu = usage.ru_utime + usage.ru_stime
    return process.returncode, cpu, wall, usage.ru_maxrss * 1024, text
