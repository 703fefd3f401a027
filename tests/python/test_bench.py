"""The driver of the benchmarks, without the program."""

import csv
import types

import pytest

from bench import decks, driver
from verify.measure import job_name


@pytest.mark.parametrize("cracks", [0, 1, 2, 4])
def test_plates_differ_in_their_cracks_alone(cracks):
    deck = decks.plate(cracks)
    assert deck.count("*CRACK") == cracks
    lines = [s for s in deck.splitlines() if s.strip()]
    plain = [s for s in decks.plate(0).splitlines() if s.strip()]
    assert [s for s in lines if s in plain] == plain
    assert job_name(deck) == "plate"


def test_extra_cost_is_the_median_ratio_of_alternating_pairs(monkeypatch):
    seconds = iter([10.0, 11.0, 13.0, 10.0, 10.0, 10.5] * 2)  # ratios 1.1, 1.3, 1.05
    order = []

    def run(deck, preset, ranks=1):
        order.append(deck.count("*CRACK"))
        return types.SimpleNamespace(cpu_s=next(seconds))

    monkeypatch.setattr(driver, "run", run)
    monkeypatch.setattr(driver, "size_of_plate", lambda preset: (480_000, 250))
    monkeypatch.setattr(driver.shutil, "which", lambda name: None)
    rows = list(driver.crack_case(1, 3))
    assert [r.case for r in rows] == ["plate-cracks-1", "plate-cracks-1-release"]
    assert rows[0].extra_cost_percent == pytest.approx(10.0)
    assert order[:6] == [0, 1, 1, 0, 0, 1]


def test_speed_leaves_set_up_out_and_memory_is_a_difference(monkeypatch):
    def run(deck, preset, ranks=1):
        steps = int(deck.split("steps = ")[1].split()[0])
        half = "20.5\n" in deck
        return types.SimpleNamespace(
            cpu_s=5.0 + 0.025 * steps,
            wall_s=5.0 + 0.025 * steps / ranks,
            peak_bytes=(256_000 if half else 512_000) * 350 + 50_000_000,
        )

    monkeypatch.setattr(driver, "run", run)
    row = next(driver.speed_case("linear"))
    assert row.mpsteps_per_core == pytest.approx(512_000 / 0.025 / 1e6)
    assert row.bytes_per_particle == pytest.approx(350)


def test_the_file_has_the_agreed_columns_and_blanks(monkeypatch, tmp_path):
    row = driver.Row("roofline", None, None, 1, 1.0, 50.0, None, None)
    monkeypatch.setattr(driver, "all_cases", lambda pairs: {"bandwidth": lambda: [row]})
    assert driver.main(["--output", str(tmp_path / "b.csv")]) == 0
    with (tmp_path / "b.csv").open() as file:
        lines = list(csv.reader(file))
    assert lines[0] == (
        "case,particles,steps,ranks,cpu_s,mpsteps_per_core,bytes_per_particle,extra_cost_percent"
    ).split(",")
    assert lines[1] == ["roofline", "", "", "1", "1", "50", "", ""]


def test_an_unknown_case_is_a_usage_error():
    assert driver.main(["no-such-case"]) == 2
