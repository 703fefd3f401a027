"""Layout and house rules of the Fortran sources."""

import io
import sys

import pytest

# fprettify takes hold of the standard streams when it is imported; pytest's are not to be taken.
streams = sys.stdin, sys.stdout, sys.stderr
sys.stdin, sys.stdout, sys.stderr = (io.TextIOWrapper(io.BytesIO()) for _ in streams)
from lint import fortran  # noqa: E402

sys.stdin, sys.stdout, sys.stderr = streams


def test_lines_that_fit_stay_as_they_are():
    text = "   x = 1   ! one\n"
    assert fortran.with_short_lines(text) == text


@pytest.mark.parametrize(
    "line",
    [
        "      call raise(error, code_usage, 'crack: triangle '//to_text(t)//' is flat, '// &",
        "   use mpi_f08, only: " + ", ".join(f"MPI_Name_{n}" for n in range(12)),
        "      value = first_long_name*second_long_name + " * 2
        + "third_long_name/fourth_long_name",
        "      call check(suite, 'one, two, three, four: a long sentence stands in here', "
        "all(values >= first) .and. any(values == second))",
    ],
)
def test_long_code_is_broken_outside_strings_and_nothing_is_lost(line):
    parts = fortran.short_lines(line, False)
    assert all(len(part) <= 100 for part in parts)
    joined = "".join(p.strip().removesuffix("&").strip() + " " for p in parts)
    assert joined.replace(" ", "") == line.strip().removesuffix("&").replace(" ", "")
    assert all(part.count("'") % 2 == 0 for part in parts)


def test_a_line_is_not_broken_before_its_ampersand():
    assert fortran.break_place("x" * 60 + " + " + "y" * 32 + ", &") == 62


def test_a_long_text_is_broken_at_a_blank_and_joined():
    line = "      call check(suite, 'a long sentence" + " with words" * 8 + "', true)"
    parts = fortran.short_lines(line, False)
    assert all(len(part) <= 100 for part in parts)
    assert "".join(p.strip() for p in parts).replace("'// &'", "") == line.strip()


def test_a_text_that_goes_on_in_the_next_line_is_left_alone():
    line = "      call raise(error, 'one text, two texts, " + "many texts, " * 6 + "&"
    assert fortran.short_lines(line, False) == [line]


def test_directives_go_on_as_directives():
    line = "      !$omp simd private(" + ", ".join(f"name_{n}" for n in range(20)) + ")"
    parts = fortran.short_lines(line, False)
    assert all(part.endswith(", &") and len(part) <= 100 for part in parts[:-1])
    assert all(part.startswith("      !$omp& name_") for part in parts[1:])


def test_long_comments_keep_their_mark():
    doc = "   !> " + "word " * 30
    assert all(p.startswith("   !> word") for p in fortran.short_lines(doc, False))
    behind = "      integer :: n   !! " + "word " * 30
    parts = fortran.short_lines(behind, False)
    assert parts[0].startswith("      integer :: n   !! word")
    assert all(p.index("!!") == behind.index("!!") and len(p) <= 100 for p in parts)


def test_the_layout_spares_continued_lines_and_strings():
    text = "program p\n   call s(a, &\n      .not. b, ',.not.')\nend program p\n"
    assert fortran.laid_out(text, "p.f90") == text


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        (["module xmpm_a", "   integer :: n", "contains"], "module variable"),
        (["module xmpm_a", "   type :: t", "      integer :: n", "   end type t"], None),
        (["module xmpm_a", "   integer, parameter :: n = 1"], None),
    ],
)
def test_modules_hold_no_variables(lines, fault):
    faults = fortran.check_state(lines)
    assert (fault is None and not faults) or fault in faults[0]


def test_layers_look_down_only(tmp_path):
    modules = {"xmpm_step": tmp_path / "solver" / "step.f90"}
    assert fortran.check_use("src/grid/a.f90", "xmpm_step", ", only: step", modules)
    assert not fortran.check_use("src/app/a.f90", "xmpm_step", ", only: step", modules)
    assert fortran.check_use("src/app/a.f90", "xmpm_step", "", modules)
