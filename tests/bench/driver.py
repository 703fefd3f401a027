"""Choose benchmarks, run them, print a table, write benchmark.csv."""

from __future__ import annotations

import argparse
import csv
import functools
import os
import re
import shutil
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from bench import decks
from verify.measure import ROOT, Run, run_command, run_deck

# What a MUSL step must move between memory and processor for a particle, in reals of 8 bytes: P2G
# reads x v m vol s (14), the velocity update reads x v m and writes v (10), the stress update reads
# x m vol s and writes x vol s (21) [B].
TRAFFIC = 8 * (14 + 10 + 21)
WARM, LONG = 60, 260  # steps of a short and a long run; their difference leaves set-up out
PRESETS = ("native", "release")


@dataclass(frozen=True)
class Row:
    """One measurement; None where a column does not apply."""

    case: str  #: name; those of the packaged build end in -release
    particles: int | None  #: number of particles
    steps: int | None  #: number of steps that were timed
    ranks: int | None  #: number of ranks
    cpu_s: float | None  #: CPU seconds of all ranks for these steps
    mpsteps_per_core: float | None  #: million particle-steps per CPU second
    bytes_per_particle: float | None  #: peak resident size at N minus that at N/2, over N/2
    extra_cost_percent: float | None  #: CPU time with cracks over that without, less one


def program(preset: str) -> Path:
    """Program of a preset."""
    return ROOT / "build" / preset / "bin" / "xmpm3d"


def suffix(preset: str) -> str:
    """What a case's name ends in for a preset."""
    return "" if preset == "native" else f"-{preset}"


def run(deck: str, preset: str, ranks: int = 1) -> Run:
    """Run a deck, keep no results."""
    result = run_deck(deck, ranks=ranks, program=program(preset), options=("--quiet",))
    shutil.rmtree(result.folder)
    return result


def speed_case(shape: str) -> Iterator[Row]:
    """Speed of the flying block on one rank and two, and bytes a particle."""
    count = 512_000
    name = f"{shape}-512k"
    for preset in PRESETS:
        walls = {}
        for ranks in (1, 2):
            short, long = ([], [])
            for _ in range(3):
                short.append(run(decks.block(shape, WARM), preset, ranks))
                long.append(run(decks.block(shape, LONG), preset, ranks))
            cpu = min(r.cpu_s for r in long) - min(r.cpu_s for r in short)
            walls[ranks] = min(r.wall_s for r in long) - min(r.wall_s for r in short)
            memory = bytes_per_particle(shape, preset, short[0], count) if ranks == 1 else None
            rate = count * (LONG - WARM) / cpu / 1e6
            yield Row(name + suffix(preset), count, LONG - WARM, ranks, cpu, rate, memory, None)
        print(f"   {name}{suffix(preset)}: two ranks are {walls[1] / walls[2]:.2f} times one")


def bytes_per_particle(shape: str, preset: str, whole: Run, count: int) -> float:
    """Growth of the peak resident size from half the particles to all of them."""
    half = run(decks.block(shape, WARM, height=20), preset)
    return (whole.peak_bytes - half.peak_bytes) / (count / 2)


def crack_case(cracks: int, pairs: int) -> Iterator[Row]:
    """CPU time of the plate with and without cracks, by alternating pairs, and instructions."""
    name = f"plate-cracks-{cracks}"
    for preset in PRESETS:
        ratios, times = [], []
        for pair in range(pairs):
            order = (cracks, 0) if pair % 2 else (0, cracks)
            cpu = {n: run(decks.plate(n), preset).cpu_s for n in order}
            ratios.append(cpu[cracks] / cpu[0])
            times.append(cpu[cracks])
        extra = 100.0 * (statistics.median(ratios) - 1.0)
        spread = 100.0 * (max(ratios) - min(ratios))
        print(f"   {name}{suffix(preset)}: {pairs} pairs, spread of the ratio {spread:.1f} %")
        count, steps = size_of_plate(preset)
        cpu_s = statistics.median(times)
        rate = count * steps / cpu_s / 1e6
        yield Row(name + suffix(preset), count, steps, 1, cpu_s, rate, None, extra)
    if shutil.which("valgrind"):
        extra = 100.0 * (instructions(cracks) / instructions(0) - 1.0)
        yield Row(f"{name}-instructions", None, None, 1, None, None, None, extra)
    else:
        print(f"   {name}: no valgrind here, instructions are not counted")


@functools.cache
def size_of_plate(preset: str) -> tuple[int, int]:
    """Particles and steps of the plate, as the program says them."""
    result = run_deck(decks.plate(0), program=program(preset))
    steps = int(result.table("energy")["step"][-1])
    shutil.rmtree(result.folder)
    found = re.search(r"particles\D*([\d,]+)", result.text)
    return int(found[1].replace(",", "")) if found else 480_000, steps


@functools.cache
def instructions(cracks: int) -> float:
    """Instructions of 20 steps of the plate, by callgrind, without those of set-up.

    Of the release build, since callgrind knows no AVX-512.
    """
    counts = []
    for steps in (2, 22):
        result = run_deck(
            decks.plate(cracks, steps),
            program=program("release"),
            options=("--quiet",),
            before=("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"),
        )
        shutil.rmtree(result.folder)
        counts.append(float(re.findall(r"Collected : (\d+)", result.text)[-1]))
    return counts[1] - counts[0]


def bandwidth_case() -> Iterator[Row]:
    """Memory bandwidth of one core, and the particle-steps that it would allow."""
    folder = ROOT / "build" / "runs"
    folder.mkdir(parents=True, exist_ok=True)
    triad = str(ROOT / "build" / "native" / "bin" / "triad")
    code, cpu, _, _, text = run_command([triad], folder, None, 600.0)
    if code != 0:
        raise RuntimeError(f"{triad} failed:\n{text}")
    gigabytes = float(text)
    print(f"   one core moves {gigabytes:.1f} GB/s; a particle-step needs {TRAFFIC} bytes at least")
    yield Row("roofline", None, None, 1, cpu, gigabytes * 1e3 / TRAFFIC, None, None)


def all_cases(pairs: int) -> dict[str, Callable[[], Iterator[Row]]]:
    """Benchmarks by name, in the order in which they run."""
    return {
        "bandwidth": bandwidth_case,
        "linear-512k": lambda: speed_case("linear"),
        "gimp-512k": lambda: speed_case("gimp"),
        "plate-cracks-1": lambda: crack_case(1, pairs),
        "plate-cracks-2": lambda: crack_case(2, pairs),
        "plate-cracks-4": lambda: crack_case(4, pairs),
    }


HEAD = f"{'case':<30}{'particles':>10}{'steps':>7}{'ranks':>6}{'cpu_s':>9}"
HEAD += f"{'Mpsteps/core':>14}{'B/particle':>12}{'extra %':>9}"


def line_of(row: Row) -> str:
    """Row as a line of the printed table."""

    def text(value: object, form: str) -> str:
        return "" if value is None else format(value, form)

    return (
        f"{row.case:<30}{text(row.particles, 'd'):>10}{text(row.steps, 'd'):>7}"
        f"{text(row.ranks, 'd'):>6}{text(row.cpu_s, '.2f'):>9}"
        f"{text(row.mpsteps_per_core, '.2f'):>14}{text(row.bytes_per_particle, '.0f'):>12}"
        f"{text(row.extra_cost_percent, '.1f'):>9}"
    )


def cells_of(row: Row) -> list[str]:
    """Row as fields of the file; nothing where a column does not apply."""
    return ["" if v is None else f"{v:.6g}" if isinstance(v, float) else v for v in astuple(row)]


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(
        prog="bench.sh", description="Speed, memory, and the cost of cracks."
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all")
    parser.add_argument(
        "--pairs", type=int, default=7, help="pairs of runs with and without cracks"
    )
    parser.add_argument("--list", action="store_true", help="list the cases and stop")
    parser.add_argument("--output", type=Path, default=ROOT / "benchmark.csv", help="CSV file")
    options = parser.parse_args(arguments)
    cases = all_cases(options.pairs)
    if options.list:
        print("\n".join(cases))
        return 0
    if unknown := sorted(set(options.cases) - set(cases)):
        print(f"no case {', '.join(unknown)}; there are: {', '.join(cases)}", file=sys.stderr)
        return 2
    started = time.monotonic()
    load = os.getloadavg()[0]
    if load > 0.5:
        print(f"   the machine is busy (load {load:.1f}): expect scatter")
    with options.output.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([f.name for f in fields(Row)])
        print(HEAD)
        for name in options.cases or cases:
            for row in cases[name]():
                print(line_of(row), flush=True)
                writer.writerow(cells_of(row))
                file.flush()
    print(f"written to {options.output} in {(time.monotonic() - started) / 60:.1f} minutes")
    return 0
