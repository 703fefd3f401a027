"""The tables of doc/deck.md are those of the program.

python tests/python/test_deck_doc.py    writes them anew
"""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "doc" / "deck.md"
MARK = "<!-- From here on made by the program: xmpm3d --keywords=markdown -->\n\n"


def find_program():
    """The program that ctest names; by hand also the release build, where there is one."""
    if "XMPM3D" in os.environ:
        return Path(os.environ["XMPM3D"])
    program = ROOT / "build" / "release" / "bin" / "xmpm3d"
    return program if program.exists() else None


def tables(program):
    """What the program says about its keywords."""
    run = subprocess.run(
        [program, "--keywords=markdown"], capture_output=True, text=True, check=True
    )
    return run.stdout.strip() + "\n"


def test_tables_of_the_deck_are_those_of_the_program():
    program = find_program()
    if program is None:
        pytest.skip("no program: set XMPM3D, or build the preset release")
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(MARK) == 1
    assert text.split(MARK)[1] == tables(program), f"run python {Path(__file__).relative_to(ROOT)}"


def test_every_keyword_has_its_heading():
    text = PAGE.read_text(encoding="utf-8")
    for keyword in ("JOB", "GRID", "MATERIAL", "BODY", "CRACK", "LOAD", "TIME", "OUTPUT"):
        assert f"### `*{keyword}" in text


if __name__ == "__main__":
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(page.split(MARK)[0] + MARK + tables(find_program()), encoding="utf-8")
