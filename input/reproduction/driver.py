"""Command line: choose examples, run them, write the table and the page."""

from __future__ import annotations

import argparse
import csv
import importlib
import sys
import time
import traceback
from dataclasses import astuple, fields
from pathlib import Path

from reproduction.study import ROOT, SIZES, Result, Study

CASES = ("plates", "cylinder", "bar", "bending", "eccentric", "rod", "tube")
TABLE = "results.csv"
PAGE = "README.md"
PICTURES = {"everyday": "", "coarse": "-coarse", "full": "-full"}

HEAD = """# Reproduction of the paper's examples

Written by `bash input/reproduce.sh`: every example of section 5 of
[doi:10.1002/nme.6653](https://doi.org/10.1002/nme.6653), run from the decks in
[input/](../../input), with its reference. Figures of the paper that have no printed numbers are
compared in kind. An error is a fraction of the reference unless the quantity says otherwise; CPU
seconds are those of all ranks. The numbers are also in [results.csv](results.csv).
"""


def example(case: str):
    """Module of an example."""
    return importlib.import_module(f"reproduction.{case}")


def title(case: str) -> str:
    """First line of the docstring of an example."""
    return (example(case).__doc__ or "").strip().splitlines()[0]


def read_results(path: Path) -> list[Result]:
    """Results of earlier calls."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    number = {"h", "value", "reference", "error", "cpu_s"}
    return [
        Result(**{k: (float(v) if v else None) if k in number else v for k, v in row.items()})
        for row in rows
    ]


def write_results(path: Path, results: list[Result]) -> None:
    """The table as a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([f.name for f in fields(Result)])
        for result in results:
            writer.writerow(["" if v is None else as_text(v) for v in astuple(result)])


def as_text(value: object) -> str:
    """A number as it is shown."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def rows_of(results: list[Result]) -> list[str]:
    """Lines of the page's table."""
    lines = [
        "| h [mm] | quantity | here | reference | error | of | CPU [s] |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in results:
        reference = "" if r.reference is None else as_text(r.reference)
        error = "" if r.error is None else f"{100 * round(r.error, 7):.2g} %"
        lines.append(
            f"| {r.h:g} | {r.quantity} | {as_text(r.value)} | {reference} | {error} | {r.source} "
            f"| {r.cpu_s:.0f} |"
        )
    return lines


def write_page(output: Path, results: list[Result]) -> None:
    """The page: for each example what was done, the table, the figures, where we differ."""
    lines = [HEAD]
    for case in CASES:
        module = example(case)
        body = "\n".join((module.__doc__ or "").strip().splitlines()[1:]).strip()
        parts = [f"## {title(case)}", body]
        if not any(r.case == case for r in results):
            parts.append(f"Not run for this table yet: `bash input/reproduce.sh {case}`.")
        for size in SIZES:
            found = [r for r in results if r.case == case and r.size == size]
            if found:
                parts += [f"Sizes: {size}.", "\n".join(rows_of(found))]
            for path in sorted(output.glob(f"{case}-*{PICTURES[size]}.png")):
                if size == "everyday" and path.stem.endswith(("-coarse", "-full")):
                    continue
                parts.append(f"![{path.stem}]({path.name})")
        parts += ["**Where and why we differ.** " + module.DIFFERS.strip()]
        lines.append("\n\n".join(parts) + "\n")
    (output / PAGE).write_text("\n".join(lines), encoding="utf-8")


def run_case(study: Study) -> list[Result]:
    """Run an example and print its results."""
    results = []
    for result in example(study.case).reproduce(study):
        reference = "" if result.reference is None else f", reference {result.reference:.4g}"
        error = "" if result.error is None else f", error {100 * result.error:.2g} %"
        print(
            f"{result.case}  h = {result.h:g}  {result.quantity}: {result.value:.4g}"
            f"{reference}{error}  ({result.cpu_s:.0f} s)",
            flush=True,
        )
        results.append(result)
    return results


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(
        prog="reproduce.sh", description="Examples of the paper against their references."
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"default: all of {CASES}")
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--full", action="store_const", dest="size", const="full",
                       help="the paper's sizes, hours")  # fmt: skip
    sizes.add_argument("--coarse", action="store_const", dest="size", const="coarse",
                       help="large cells, a minute for all: only to see that it works")  # fmt: skip
    parser.add_argument("--list", action="store_true", help="list the cases and stop")
    parser.add_argument("--ranks", type=int, default=2, help="default: 2")
    parser.add_argument("--output", type=Path, default=ROOT / "doc" / "reproduction")
    parser.add_argument("--work", type=Path, default=ROOT / "results" / "reproduction")
    options = parser.parse_args(arguments)
    if options.list:
        for case in CASES:
            print(f"{case:<12} {title(case)}")
        return 0
    if unknown := sorted(set(options.cases) - set(CASES)):
        print(f"no case {', '.join(unknown)}; there are: {', '.join(CASES)}", file=sys.stderr)
        return 2
    started = time.monotonic()
    failed = []
    size = options.size or "everyday"
    for case in options.cases or CASES:
        study = Study(case, size, options.ranks, options.output.resolve(), options.work.resolve())
        try:
            new = run_case(study)
        except Exception:
            traceback.print_exc()
            failed.append(case)
            continue
        table = study.output / TABLE
        kept = [r for r in read_results(table) if (r.case, r.size) != (case, size)]
        results = sorted([*kept, *new], key=lambda r: (CASES.index(r.case), SIZES.index(r.size)))
        write_results(table, results)
        write_page(study.output, results)
    for case in failed:
        print(f"{case}: did not run to its end")
    print(f"{(time.monotonic() - started) / 60:.1f} minutes; see {options.output / PAGE}")
    return 1 if failed else 0
