"""Layout and house rules of the Fortran sources.

usage: fortran.py [--fix] [FILE ...]        (default: all of src and tests)

Layout is fprettify's, with 3 spaces a level; the indentation of continued lines is left to the
writer, since fprettify would align them with the last bracket. --fix writes the layout and breaks
lines that pass column 100.
The house rules are few and mechanical: one module a file under its file's name, layers that only
look down, `use` with `only`, no variables that outlive a call, procedures of bounded length, a
sentence above every module.
"""

from __future__ import annotations

import argparse
import io
import re
import sys
import textwrap
from pathlib import Path

import fprettify

ROOT = Path(__file__).resolve().parents[2]
LAYERS = [
    "base",
    "parallel",
    "io",
    "grid",
    "materials",
    "particles",
    "enrichment",
    "fracture",
    "solver",
    "app",
]
WIDTH = 100  # columns
LONGEST = 60  # lines of a procedure, from its statement to its end
# The main program; the files that may use all of HDF5; tables may be longer than procedures.
PROGRAMS = {"src/app/xmpm3d.f90"}
WHOLE_USE = re.compile(r"src/io/hdf5_\w+\.f90")
TABLES = re.compile(r"src/io/\w+_table\.f90")

USE = re.compile(r"^use\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*(\w+)\s*(.*)$", re.I)
BEGIN = re.compile(
    r"^(?:(?:pure|elemental|impure|recursive|module|logical|integer|real|character|type|class|complex)"
    r"(?:\s*\([^)]*\))?\s+)*(?:subroutine|function)\s+(\w+)",
    re.I,
)
END = re.compile(r"^end\s*(?:subroutine|function)\b", re.I)
STATE = re.compile(r"^(?:save\b(?!\s*=)|common\s*/|equivalence\s*\(|.*,\s*save\b.*::)", re.I)
DECLARED = re.compile(
    r"^(?:logical|integer|real|character|complex|type\s*\(|class|procedure).*::", re.I
)
NOT = re.compile(r"('[^'\n]*'|\"[^\"\n]*\")|,(?=\.not\.)")
INNER = re.compile(r"^(?:type\b(?!\s*\()|(?:abstract\s+)?interface\b)", re.I)
INNER_END = re.compile(r"^end\s*(?:type|interface)\b", re.I)


def laid_out(text: str, name: str) -> str:
    """The text as fprettify would have it, but with its own continuation indents."""
    result = io.StringIO()
    fprettify.reformat_ffile(
        io.StringIO(text),
        result,
        indent_size=3,
        strict_indent=True,
        whitespace=2,
        llength=1000,
        orig_filename=name,
    )
    # fprettify drops the blank between a comma and `.not.`.
    wanted = NOT.sub(lambda m: m[1] or ", ", result.getvalue()).splitlines()
    given = text.splitlines()
    if len(wanted) != len(given):
        return "\n".join(wanted) + "\n"
    continued = False
    for number, line in enumerate(given):
        code = without_strings(line)
        if continued and line.strip():
            indent = line[: len(line) - len(line.lstrip())]
            wanted[number] = indent + wanted[number].lstrip()
        if not line.lstrip().startswith("!"):
            continued = code.split("!")[0].rstrip().endswith("&")
    return "\n".join(wanted) + "\n"


def without_strings(line: str) -> str:
    """The line with the content of its character literals replaced."""
    return re.sub(r"'[^']*'|\"[^\"]*\"", lambda m: "'" + "x" * (len(m[0]) - 2) + "'", line)


def check_layout(path: Path, fix: bool) -> list[str]:
    """Lines of a file that are not laid out as agreed."""
    text = path.read_text()
    wanted = laid_out(text, str(path))
    if fix:
        wanted = with_short_lines(wanted)
        if text != wanted:
            path.write_text(wanted)
        return []
    pairs = zip(text.splitlines(), wanted.splitlines(), strict=False)
    faults = [
        f"{number}: layout, wanted: {want}"
        for number, (have, want) in enumerate(pairs, 1)
        if have != want
    ]
    if not faults and text != wanted:
        faults = ["1: layout, number of lines or the last line's end"]
    return faults


def with_short_lines(text: str) -> str:
    """Break what passes the last column: code after a comma or operator, comments at a blank."""
    result: list[str] = []
    continued = False
    for line in text.splitlines():
        result += short_lines(line, continued)
        if not line.lstrip().startswith("!"):
            continued = without_strings(line).split("!")[0].rstrip().endswith("&")
    return "\n".join(result) + "\n"


def short_lines(line: str, continued: bool) -> list[str]:
    """Break one line where it is too long; leave it where no place to break is found."""
    if len(line) <= WIDTH:
        return [line]
    indent = " " * (len(line) - len(line.lstrip()))
    if re.match(r"\s*![$]omp\b", line, re.I):
        place = line.rfind(",", 0, WIDTH - 2) + 1
        return [line[:place] + " &", *short_lines(f"{indent}!$omp& {line[place:].lstrip()}", True)]
    if re.match(r"\s*!(?![$]|GCC[$])", line):
        return wrapped("", line.lstrip(), indent)
    masked = without_strings(line)
    mark = masked.find("!")
    code = line if mark < 0 else line[:mark].rstrip()
    if mark >= 0 and len(code) < WIDTH - 30:
        if line.startswith("!!", mark):
            return wrapped(line[:mark], line[mark:], " " * mark)
        return [*wrapped("", line[mark:], indent), code]
    if re.search("['\"]", re.sub(r"'x*'", "", masked[: len(code)])):
        return [line]  # a text that goes on in the next line
    inner = indent if continued else indent + "   "
    if place := break_place(masked[: len(code)]):
        rest = inner + line[place:].lstrip()
        return [line[:place].rstrip() + " &", *short_lines(rest, True)]
    for m in re.finditer(r"'[^']*'|\"[^\"]*\"", line[: len(code)]):
        place = line.rfind(" ", m.start() + 2, min(m.end() - 2, WIDTH - 5)) + 1
        if m.end() > WIDTH - 5 and place > m.start():
            rest = inner + m[0][0] + line[place:]
            return [line[:place] + m[0][0] + "// &", *short_lines(rest, True)]
    return [line]


def wrapped(before: str, comment: str, indent: str) -> list[str]:
    """Break a comment at blanks; its further lines begin with the same mark after the indent."""
    mark = re.match(r"![>!<]?\s*", comment)[0]
    return textwrap.wrap(
        comment[len(mark) :],
        WIDTH,
        break_on_hyphens=False,
        initial_indent=(before or indent) + mark,
        subsequent_indent=indent + mark,
    )


def break_place(code: str) -> int | None:
    """Find the last good place to break: outside most brackets, in the second half of the line."""
    depth = 0
    best: tuple[int, int] | None = None
    for place, letter in enumerate(code[: WIDTH - 2]):
        depth += (letter in "([") - (letter in ")]")
        after = code[place + 1 :]
        operator = re.search(r"(,|//|\.and\.|\.or\.| [-+*/=<>]+)$", code[: place + 1], re.I)
        good = (
            operator
            and not after.startswith(("/", "=", ">", "*"))
            and after.strip() not in ("", "&")
        )
        if good and place > 45 and (best is None or depth <= best[0]):
            best = (depth, place + 1)
    return best[1] if best else None


def check_rules(path: Path, modules: dict[str, Path]) -> list[str]:
    """Places in a file where a house rule is broken."""
    name = path.relative_to(ROOT).as_posix()
    lines = path.read_text().splitlines()
    faults = []
    if name.startswith("src/") and name not in PROGRAMS:
        faults += check_module(path, lines) + check_state(lines)
    start: list[tuple[str, int]] = []
    for number, line in statements(lines):
        if STATE.match(line):
            faults.append(f"{number}: a variable that outlives the call: {line}")
        if m := USE.match(line):
            faults += [f"{number}: {f}" for f in check_use(name, m[1], m[2], modules)]
        if END.match(line) and start:
            what, first = start.pop()
            if number - first + 1 > LONGEST and not TABLES.fullmatch(name):
                faults.append(f"{first}: {what} has {number - first + 1} lines; {LONGEST} at most")
        elif m := BEGIN.match(line):
            start.append((m[1], number))
    return faults


def statements(lines: list[str]) -> list[tuple[int, str]]:
    """First lines of statements without comment and indent, and their numbers."""
    found = []
    continued = False
    for number, line in enumerate(lines, 1):
        code = without_strings(line).split("!")[0].strip()
        if code and not continued:
            found.append((number, code))
        if code:
            continued = code.endswith("&")
    return found


def check_module(path: Path, lines: list[str]) -> list[str]:
    """A file holds one module of its own name, with a sentence above it."""
    faults = []
    opening = re.compile(r"^module\s+(?!procedure\b|subroutine\b|function\b)(\w+)$")
    found = [(n, m[1]) for n, line in enumerate(lines, 1) if (m := opening.match(line))]
    if [name for _, name in found] != [f"xmpm_{path.stem}"]:
        faults.append(f"1: must hold exactly module xmpm_{path.stem}, has {[f for _, f in found]}")
    else:
        first = found[0][0] - 1
        while first > 0 and lines[first - 1].startswith("!!"):
            first -= 1
        if not lines[max(first - 1, 0)].startswith("!>"):
            faults.append(f"{found[0][0]}: no sentence `!>` above module {found[0][1]}")
    return faults


def check_state(lines: list[str]) -> list[str]:
    """Modules declare constants, not variables."""
    faults = []
    inner = False
    for number, line in statements(lines):
        if line.lower() == "contains" and not inner:
            break
        if INNER_END.match(line):
            inner = False
        elif INNER.match(line):
            inner = True
        elif not inner and DECLARED.match(line) and "parameter" not in line.lower():
            faults.append(f"{number}: module variable: {line}")
    return faults


def check_use(name: str, module: str, rest: str, modules: dict[str, Path]) -> list[str]:
    """`use` names what it takes, and looks to its own layer or below."""
    faults = []
    whole = module.lower() == "hdf5" and WHOLE_USE.fullmatch(name)
    if "only" not in rest.lower() and not whole:
        faults.append(f"use of {module} without only")
    used = modules.get(module.lower())
    if name.startswith("src/") and used:
        here, there = name.split("/")[1], used.parent.name
        if LAYERS.index(there) > LAYERS.index(here):
            faults.append(f"layer {here} uses {module} of layer {there}, which is above it")
    return faults


def main() -> int:
    """Check all files; 0 where nothing was found."""
    parser = argparse.ArgumentParser(description="Layout and house rules of the Fortran sources.")
    parser.add_argument("--fix", action="store_true", help="write the layout that is wanted")
    parser.add_argument("files", nargs="*", type=Path, help="default: all")
    options = parser.parse_args()
    modules = {f"xmpm_{p.stem}": p for p in ROOT.glob("src/*/*.f90")}
    files = [f.resolve() for f in options.files] or sorted(
        [*ROOT.glob("src/*/*.f90"), *ROOT.glob("tests/**/*.f90")]
    )
    faults = 0
    for path in files:
        found = check_layout(path, options.fix) + check_rules(path, modules)
        for fault in found:
            print(f"{path.relative_to(ROOT)}:{fault}")
        faults += len(found)
    print(f"Fortran layout and house rules: {len(files)} files, {faults} faults")
    return 1 if faults or not files else 0


if __name__ == "__main__":
    sys.exit(main())
