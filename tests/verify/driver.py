"""Choose cases, run them, print a table, write verification.csv."""

from __future__ import annotations

import argparse
import csv
import importlib
import math
import os
import pkgutil
import queue
import sys
import time
import traceback
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple, dataclass, fields
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Row:
    """One compared number. Error and limit are fractions; a limit of None only reports."""

    case: str  #: name of the case
    method: str  #: what is compared: shape functions, scheme, front rule, estimator
    h: float  #: cell size, in units of the deck
    ranks: int  #: number of ranks
    quantity: str  #: what was measured, with its unit
    value: float  #: as computed
    reference: float  #: as it should be
    error: float  #: by default |value - reference| / |reference|
    limit: float | None  #: largest error allowed
    cpu_s: float  #: CPU seconds of the run behind it

    @classmethod
    def of(
        cls,
        case: str,
        method: str,
        h: float,
        run: object,
        quantity: str,
        value: float,
        reference: float,
        limit: float | None,
        error: float | None = None,
    ) -> Row:
        """Row of a finished run, with the relative error unless another is given."""
        if error is None:
            error = abs(value - reference) / abs(reference)
        return cls(case, method, h, run.ranks, quantity, value, reference, error, limit, run.cpu_s)

    @property
    def holds(self) -> bool:
        """Whether the error is a number within its limit."""
        return math.isfinite(self.error) and (self.limit is None or self.error <= self.limit)


def case_names(package: str = "verify.cases") -> list[str]:
    """All cases, by name."""
    folder = importlib.import_module(package).__path__
    return sorted(m.name.replace("_", "-") for m in pkgutil.iter_modules(folder))


def load(name: str, package: str = "verify.cases"):
    """Module of a case."""
    return importlib.import_module(f"{package}.{name.replace('-', '_')}")


def rows_of(name: str, full: bool, failures: list[str]) -> Iterator[Row]:
    """Rows of a case; a failure is printed and noted, and the next case goes on."""
    try:
        yield from load(name).rows(full)
    except Exception:
        traceback.print_exc()
        failures.append(name)


HEAD = f"{'case':<16}{'method':<14}{'h':>9}{'ranks':>6}  {'quantity':<34}"
HEAD += f"{'value':>13}{'reference':>13}{'error':>10}{'limit':>9}{'cpu_s':>9}"


def line_of(row: Row) -> str:
    """Row as a line of the printed table."""
    limit = "-" if row.limit is None else f"{row.limit:.3g}"
    text = f"{row.case:<16}{row.method:<14}{row.h:>9.4g}{row.ranks:>6}  {row.quantity:<34}"
    text += f"{row.value:>13.6g}{row.reference:>13.6g}{row.error:>10.3g}{limit:>9}{row.cpu_s:>9.1f}"
    return text if row.holds else text + "  OVER ITS LIMIT"


def cells_of(row: Row) -> list[str]:
    """Row as fields of the file; nothing where there is no limit."""
    return ["" if v is None else f"{v:.9g}" if isinstance(v, float) else v for v in astuple(row)]


def rows_in_parallel(names: list[str], full: bool, jobs: int, failures: list[str]) -> Iterator[Row]:
    """Rows of several cases at a time, as they come."""
    rows: queue.SimpleQueue = queue.SimpleQueue()

    def run(name: str) -> None:
        for row in rows_of(name, full, failures):
            rows.put(row)
        rows.put(None)

    with ThreadPoolExecutor(jobs) as pool:
        for name in names:
            pool.submit(run, name)
        left = len(names)
        while left:
            row = rows.get()
            if row is None:
                left -= 1
            else:
                yield row


def verify(names: list[str], full: bool, path: Path, jobs: int = 1) -> int:
    """Run cases; 0 where every one ran and every error is within its limit."""
    failures: list[str] = []
    over = 0
    count = 0
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([f.name for f in fields(Row)])
        print(HEAD)
        for row in rows_in_parallel(names, full, jobs, failures):
            print(line_of(row), flush=True)
            writer.writerow(cells_of(row))
            file.flush()
            count += 1
            over += not row.holds
    for name in failures:
        print(f"{name}: did not run to its end")
    print(f"{count} rows, {over} over their limit, {len(failures)} cases failed; see {path}")
    return 1 if over or failures or not count else 0


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(
        prog="verify.sh", description="Cases against reference solutions."
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all")
    parser.add_argument("--full", action="store_true", help="also the sizes that take hours")
    parser.add_argument("--list", action="store_true", help="list the cases and stop")
    parser.add_argument("--output", type=Path, default=ROOT / "verification.csv", help="CSV file")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count(), help="cases at a time, by default one a core"
    )
    options = parser.parse_args(arguments)
    known = case_names()
    if options.list:
        for name in known:
            print(f"{name:<16} {(load(name).__doc__ or '').strip().splitlines()[0]}")
        return 0
    if unknown := sorted(set(options.cases) - set(known)):
        print(f"no case {', '.join(unknown)}; there are: {', '.join(known)}", file=sys.stderr)
        return 2
    started = time.monotonic()
    # Open MPI would bind the first rank of every run to the same core.
    os.environ.setdefault("OMPI_MCA_hwloc_base_binding_policy", "none")
    status = verify(options.cases or known, options.full, options.output, max(1, options.jobs))
    print(f"{(time.monotonic() - started) / 60:.1f} minutes")
    return status
