"""The driver of input/reproduce.sh, without the program."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "input"))

from reproduction import driver
from reproduction.study import ROOT, Result, change_key

DECK = """*TIME end = 0.4, scheme = musl   ! late
*GROWTH
  cracks = notch, law = running
*END
"""


def test_a_key_that_is_there_is_changed_and_its_comment_stays():
    assert "*TIME end = 0.1, scheme = musl   ! late\n" in change_key(DECK, "TIME", "end", 0.1)


def test_a_key_that_is_not_there_is_added_to_its_block():
    deck = change_key(DECK, "GROWTH", "increment", 0.25)
    assert "*GROWTH\n  increment = 0.25\n  cracks = notch, law = running\n" in deck


def test_a_block_that_is_not_there_is_an_error():
    with pytest.raises(KeyError):
        change_key(DECK, "FRACTURE", "every", 1)


def test_results_come_back_from_the_file_as_they_were_written(tmp_path):
    results = [
        Result("rod", "coarse", 5.0, "a, b [mm]", 1.5, None, None, "", 2.0),
        Result("tube", "full", 1.0, "c", 1.5, 2.0, 0.25, "eq. 1", 2.0),
    ]
    driver.write_results(tmp_path / "r.csv", results)
    assert driver.read_results(tmp_path / "r.csv") == results


def test_the_page_has_every_example_with_its_numbers_and_where_it_differs(tmp_path):
    (tmp_path / "rod-modes-coarse.png").touch()
    (tmp_path / "rod-modes.png").touch()
    result = Result("rod", "everyday", 2.0, "end [us]", 30.0, 22.5, 1 / 3, "figure 24", 7.0)
    driver.write_page(tmp_path, [result])
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert page.count("**Where and why we differ.**") == len(driver.CASES)
    assert "| 2 | end [us] | 30 | 22.5 | 33 % | figure 24 | 7 |" in page
    assert page.count("(rod-modes.png)") == 1
    assert page.count("(rod-modes-coarse.png)") == 1


def test_every_deck_of_the_paper_has_an_example():
    used = "".join(
        path.read_text(encoding="utf-8") for path in (ROOT / "input/reproduction").glob("*.py")
    )
    for deck in (ROOT / "input").glob("*.inp"):
        name = deck.stem
        assert f'"{name}"' in used or (name.startswith("plate-") and 'f"plate-{n}"' in used)
