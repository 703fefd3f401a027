"""The driver of the verification cases, without the program."""

import csv
import sys

import pytest

from verify import driver, measure
from verify.driver import Row


def row(value, limit=0.01):
    return Row("some-case", "musl", 1.0, 1, "x [mm]", value, 2.0, abs(value - 2) / 2, limit, 0.5)


def test_places_of_a_deck_are_filled_with_all_digits():
    assert measure.fill("a = @a@, b = @b@", a=0.1 + 0.2, b=[1, 2.5]) == (
        "a = 0.30000000000000004, b = 1 2.5"
    )


@pytest.mark.parametrize("values", [{}, {"a": 1, "b": 2}])
def test_a_place_without_value_and_a_value_without_place_are_errors(values):
    with pytest.raises(KeyError):
        measure.fill("a = @a@", **values)


def test_the_name_of_the_job_is_found():
    assert measure.job_name("! first\n*job plate-1   ! comment\n*UNITS length = mm\n") == "plate-1"


def test_tables_skip_comments_and_keep_text(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("# units: ms,-,mm\ntime,crack,u\n0.0,slit,1.5\n1e-3,slit,2\n")
    table = measure.read_table(path)
    assert list(table["u"]) == [1.5, 2.0]
    assert list(table["crack"]) == ["slit", "slit"]


def test_cpu_time_and_memory_of_grandchildren_are_counted(tmp_path):
    work = "x = bytearray(200_000_000); sum(range(20_000_000))"
    parent = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {work!r}], check=True)"
    code, cpu, _, peak, _ = measure.run_command([sys.executable, "-c", parent], tmp_path, None, 60)
    assert code == 0
    assert cpu > 0.1  # the sum takes about 0.3 s; an idle parent 0.03 s
    assert peak > 2e8  # the child's array


def test_a_command_beyond_its_limit_is_ended(tmp_path):
    command = [sys.executable, "-c", "import time; time.sleep(60)"]
    code, _, wall, _, _ = measure.run_command(command, tmp_path, None, 0.5)
    assert code != 0
    assert wall < 30


def test_an_error_over_its_limit_fails_the_verification(monkeypatch, tmp_path):
    path = tmp_path / "v.csv"
    for value, status in ((2.01, 0), (2.03, 1), (float("nan"), 1)):
        monkeypatch.setattr(driver, "rows_of", lambda *_, v=value: [row(v)])
        assert driver.verify(["some-case"], False, path) == status
    with path.open() as file:
        header = next(csv.reader(file))
    assert header == "case,method,h,ranks,quantity,value,reference,error,limit,cpu_s".split(",")


def test_a_case_that_raises_and_a_table_without_rows_fail(monkeypatch, tmp_path, capsys):
    class Broken:
        @staticmethod
        def rows(full):
            raise measure.RunError("no such program")
            yield

    monkeypatch.setattr(driver, "load", lambda name: Broken)
    assert driver.verify(["broken"], False, tmp_path / "v.csv") == 1
    assert "broken: did not run to its end" in capsys.readouterr().out


def test_an_unknown_case_is_a_usage_error(capsys):
    assert driver.main(["no-such-case"]) == 2
    assert "bar-wave" in capsys.readouterr().err


def test_every_case_says_what_it_is():
    for name in driver.case_names():
        case = driver.load(name)
        assert case.__doc__.strip().splitlines()[0].endswith(".")
        assert callable(case.rows)
