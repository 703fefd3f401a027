"""Order of convergence of the manufactured solution (tests/unit/test_manufactured.f90).

The error is the rms of the displacement's error over all particles, over the amplitude, at three
quarters of a period. Wanted: order 1.8 for GIMP at an amplitude of 0.2 h and for linear functions
at 1e-6 h. Linear functions at 0.2 h are shown with the order of about 1 that particles near cell
faces leave them: their gradient jumps there.

Recorded on 2026-11-22 at 1/16, 1/32, 1/64: GIMP, 0.2 h: 7.66e-3, 1.94e-3, 4.39e-4 (order 2.06 from
the first to the last); linear, 1e-6 h: 1.05e-2, 2.78e-3, 7.00e-4 (1.96); linear, 0.2 h, 1/16 and
1/32: 3.31e-2 and 1.32e-2 (1.33).
"""

import math
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

from verify import Row

WANTED = {("gimp", 0.2): 1.8, ("linear", 1e-6): 1.8, ("linear", 0.2): None}


def rows(full: bool) -> Iterator[Row]:
    """One row a grid with its error, and one with the order between the two finest."""
    cells = (16, 32, 64) if full else (16, 32)
    test = Path(os.environ["XMPM3D"]).parents[1] / "tests" / "test_manufactured"
    for (shape, amplitude), wanted in WANTED.items():
        errors = []
        for n in cells:
            before = os.times()
            done = subprocess.run(
                [test, shape, str(amplitude), str(n)], capture_output=True, text=True, check=True
            )
            after = os.times()
            cpu = after.children_user - before.children_user + after.children_system
            cpu -= before.children_system
            errors.append(float(done.stdout.split()[-1]))
            yield Row(
                "manufactured", f"{shape} {amplitude:g} h", 1 / n, 1, "rms error of displacement",
                errors[-1], 0.0, errors[-1], None, cpu,
            )  # fmt: skip
        order = math.log(errors[-2] / errors[-1]) / math.log(cells[-1] / cells[-2])
        limit = None if wanted is None else (2 - wanted) / 2
        yield Row(
            "manufactured", f"{shape} {amplitude:g} h", 1 / cells[-1], 1, "order", order, 2.0,
            max(0.0, (2 - order) / 2), limit, 0.0,
        )  # fmt: skip
