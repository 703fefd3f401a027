"""Order of convergence of the manufactured solution (tests/unit/test_manufactured.f90).

The error is the rms of the displacement's error over all particles, over the amplitude, at three
quarters of a period. Wanted: order 1.8 for GIMP at an amplitude of 0.2 h and for linear functions
at 1e-6 h. Linear functions at 0.2 h are shown with the order of about 1 that particles near cell
faces leave them: their gradient jumps there.
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
