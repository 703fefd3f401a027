"""Verification: cases against reference solutions, accuracy and cost on one line.

A case is a module of verify.cases with a docstring, whose first line is shown by --list, and a
generator `rows(full)` that runs the program and yields a Row for each number that it compares.
"""

from verify.driver import Row
from verify.measure import Run, RunError, fill, run_deck

__all__ = ["Row", "Run", "RunError", "fill", "run_deck"]
