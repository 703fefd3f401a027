"""Compares the result files of runs with each other or with values of known source.

compare.py same FIRST SECOND                     two runs are identical bit for bit
compare.py agree FIRST SECOND TOLERANCE [SOURCE]  two runs agree over the largest of each field
compare.py mirror FIRST SECOND AXIS TOLERANCE    the second is the mirror image of the first
compare.py check RUN [OTHER] < TABLE             values; a line is NAME | VALUE | EXPECTED |
                                                 TOLERANCE | SOURCE, see `names_of`

A run is FOLDER/NAME, NAME being the deck's job. Every row is printed; exit 1 if one fails.
"""

import math
import re
import sys
from pathlib import Path

import h5py
import numpy as np

ENERGIES = "kinetic strain external damping transfer plastic contact fracture balance_error".split()
SINGLE = 2.5e-7  # two roundings to single precision, over the largest value


def read_table(path: Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file; 17 digits give back every bit."""
    lines = [line for line in path.read_text().splitlines() if line and line[0] != "#"]
    rows = [line.split(",") for line in lines[1:]]
    columns = dict(zip(lines[0].split(","), zip(*rows, strict=True), strict=True))
    columns.pop("crack", None)  # a name, not a number
    return {name: np.array(cells, dtype=float) for name, cells in columns.items()}


def step_files(run: str, kind: str = "particles") -> list[Path]:
    """Step files of the particles of a run, or of its cracks, in order."""
    path = Path(run)
    return sorted((path.parent / f"{path.name}_{kind}").glob("*.vtkhdf"))


def read_particles(path: Path) -> dict[str, np.ndarray]:
    """Points and fields of a step file, by the particles' ids."""
    with h5py.File(path) as file:
        group = file["VTKHDF"]
        fields = {name: data[()] for name, data in group["PointData"].items()}
        fields["x"] = group["Points"][()]
    order = np.argsort(fields["id"], kind="stable") if "id" in fields else slice(None)
    return {name: data[order] for name, data in fields.items()}


def field_of(column: str) -> str:
    """Name of the field that a column belongs to: energies are one, components of a vector too."""
    if column in ENERGIES:
        return "energy"
    if re.match(r"[JK]_", column):
        return column[0]
    return re.sub(r"_([xyz]|xx|yy|zz|xy|yz|xz)$", "", column)


def table_differences(first: dict, second: dict) -> dict[str, float]:
    """Largest difference of each field over its largest magnitude."""
    assert list(first) == list(second), "the tables have other columns"
    for table in (first, second):
        if "kink_angle" in table:  # means nothing where there is no K
            table["kink_angle"] = table["kink_angle"] * table["K_star"]
    fields: dict[str, list[str]] = {}
    for name in first:
        fields.setdefault(field_of(name), []).append(name)
    result = {}
    for field, names in fields.items():
        a = np.stack([first[n] for n in names])
        b = np.stack([second[n] for n in names])
        assert a.shape == b.shape, "the tables have other lengths"
        scale = 1.0 if field in ("relative_error", "fracture_error") else np.abs(a).max()
        result[field] = relative(a, b, scale)
    return result


def relative(a: np.ndarray, b: np.ndarray, scale: float) -> float:
    """Largest difference over a scale."""
    largest = float(np.abs(a - b).max())
    return largest / float(scale) if largest > 0 else largest


def particle_differences(first: str, second: str) -> dict[str, float]:
    """Largest differences of the last step: of the path since the start, and of the fields."""
    a, b = read_particles(step_files(first)[-1]), read_particles(step_files(second)[-1])
    start = read_particles(step_files(first)[0])["x"]
    result = {"path": relative(a["x"] - start, b["x"] - start, np.abs(a["x"] - start).max())}
    for name in sorted(set(a) - {"x", "rank"}):
        one, two = a[name].astype(float), b[name].astype(float)
        result[name] = relative(one, two, np.abs(one).max())
    return result


def mirror_image(fields: dict[str, np.ndarray], axis: int) -> dict[str, np.ndarray]:
    """Particle fields seen in a mirror; tensors are xx yy zz xy yz xz."""
    signs = np.where(np.arange(3) == axis, -1, 1)
    shears = np.array([signs[0] * signs[1], signs[1] * signs[2], signs[0] * signs[2]])
    result = dict(fields)
    for name in {"x", "displacement", "velocity"} & set(fields):
        result[name] = fields[name] * signs
    if "stress" in fields:
        result["stress"] = fields["stress"] * np.concatenate([np.ones(3), shears])
    return result


def mirror(first: str, second: str, axis: int, tolerance: float) -> bool:
    """Show how far the second run is the mirror image of the first."""
    runs = []
    for run in (first, second):
        steps = [read_particles(step_files(run)[i]) for i in (0, -1)]
        if run == second:
            steps = [mirror_image(step, axis) for step in steps]
        order = np.lexsort(np.round(steps[0]["x"], 9).T)
        runs.append([{name: data[order] for name, data in step.items()} for step in steps])
    good, source = True, "the mirror image"
    start = np.abs(runs[0][0]["x"] - runs[1][0]["x"]).max()
    good &= show("particles: start", float(start), 0, 1e-12, source)
    (a0, a), (b0, b) = runs
    path, image = a["x"] - a0["x"], b["x"] - b0["x"]
    good &= show("particles: path", relative(path, image, np.abs(path).max()), 0, tolerance, source)
    for name in sorted({"velocity", "stress"} & set(a)):
        one, two = a[name].astype(float), b[name].astype(float)
        value = relative(one, two, np.abs(one).max())
        good &= show(f"particles: {name}", value, 0, max(tolerance, SINGLE), source)
    tables = [read_table(Path(f"{run}_energy.csv")) for run in (first, second)]
    for name in ("kinetic", "strain", "external"):
        value = relative(tables[0][name], tables[1][name], np.abs(tables[0][name]).max())
        good &= show(f"energy: {name}", value, 0, tolerance, source)
    return good


def show(name: str, value: float, expected: float, tolerance: float, source: str) -> bool:
    """Print a row; tells whether it holds."""
    good = math.isfinite(value) and abs(value - expected) <= tolerance
    print(
        f"{'ok    ' if good else 'FAILED'} {name:34} {value: .9e}  expected {expected: .9e}"
        f"  tolerance {tolerance:.1e}  ({source})"
    )
    return good


def tables_of(run: str) -> list[str]:
    """CSV files of a run."""
    path = Path(run)
    return sorted(p.name for p in path.parent.glob(f"{path.name}_*.csv"))


def agree(first: str, second: str, tolerance: float, single: float, source: str) -> bool:
    """Show how far two runs agree, field by field."""
    assert tables_of(first) == tables_of(second), "the runs have other tables"
    good = True
    for name in tables_of(first):
        one, two = (read_table(Path(run).parent / name) for run in (first, second))
        for field, value in table_differences(one, two).items():
            good &= show(f"{name[:-4]}: {field}", value, 0, tolerance, source)
    for field, value in particle_differences(first, second).items():
        limit = tolerance if field == "path" else single
        good &= show(f"particles: {field}", value, 0, limit, source)
    return good


def names_of(run: str) -> dict:
    """What values in a table of checks can be made of.

    `energy`, `probe` and `front` are dictionaries of columns; `start` and `last` those of the
    particles' first and last step, `crack` that of the last crack surface; `np`, and some functions
    of Python.
    """
    path = Path(run)
    names = {"np": np, "abs": abs, "max": max, "min": min, "len": len, "set": set}
    for kind in ("energy", "probe", "front"):
        table = path.parent / f"{path.name}_{kind}.csv"
        if table.exists():
            names[kind] = read_table(table)
    if step_files(run):
        names["start"] = read_particles(step_files(run)[0])
        names["last"] = read_particles(step_files(run)[-1])
    if step_files(run, "crack"):
        names["crack"] = read_particles(step_files(run, "crack")[-1])
    return names


def check(run: str, rows: str, other: str | None) -> bool:
    """Show and judge the values of a table; names of another run begin with `other_`."""
    names = names_of(run)
    if other:
        names |= {f"other_{name}": value for name, value in names_of(other).items()}
    good, count = True, 0
    for row in rows.splitlines():
        if not row.strip():
            continue
        name, value, expected, tolerance, source = (cell.strip() for cell in row.split("|"))
        numbers = (float(eval(text, {}, names)) for text in (value, expected, tolerance))
        good &= show(name, *numbers, source)
        count += 1
    assert count > 0, "nothing to check"
    return good


def main(words: list[str]) -> int:
    """Run a command; 0 where all rows hold."""
    command, rest = words[0], words[1:]
    if command == "same":
        good = agree(rest[0], rest[1], 0.0, 0.0, "the same ranks: bit for bit")
    elif command == "agree":
        source = rest[3] if len(rest) > 3 else "the same run on other ranks"
        good = agree(rest[0], rest[1], float(rest[2]), SINGLE, source)
    elif command == "mirror":
        good = mirror(rest[0], rest[1], "xyz".index(rest[2]), float(rest[3]))
    else:
        good = check(rest[0], sys.stdin.read(), rest[1] if len(rest) > 1 else None)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
