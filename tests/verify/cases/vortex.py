"""Finite rotation: a vortex turns the middle of a block by 1 rad (tests/unit/test_vortex.f90).

The manufactured solution for hypoelastic material with the Jaumann rate: circles turn by
(1 - R^2)^3 rad at t = 1/2, sheared by up to 0.89. Errors are rms over all particles and over the
rms of the quantity. Particles leave the lattice they began on, and the quadrature of the forces is
what limits the order: stresses stop improving at about 4 % (GIMP), and linear functions, whose
gradient jumps at cell faces, do not converge beyond 1/32.
"""

import math
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

from verify import Row

# recorded on 2026-11-22, as 1/h: displacement, shear stress
# linear  8: 0.0820 0.1420   16: 0.0242 0.1051   32: 0.0154 0.1516   64: 0.0239 0.2112
# GIMP    8: 0.0888 0.1250   16: 0.0246 0.0439   32: 0.0076 0.0368   64: 0.0032 0.0506
LIMITS = {("gimp", 16): (0.03, 0.05), ("gimp", 32): (0.01, 0.05), ("linear", 16): (0.03, 0.12)}
QUANTITIES = "rms error of displacement", "rms error of shear stress"


def rows(full: bool) -> Iterator[Row]:
    """Two rows a grid, and one with the order of GIMP."""
    test = Path(os.environ["XMPM3D"]).parents[1] / "tests" / "test_vortex"
    for shape in ("linear", "gimp"):
        found = {}
        for n in (8, 16, 32, 64) if full else (8, 16, 32):
            before = os.times()
            done = subprocess.run([test, shape, str(n)], capture_output=True, text=True, check=True)
            after = os.times()
            cpu = after.children_user - before.children_user + after.children_system
            cpu -= before.children_system
            errors = [float(word) for word in done.stdout.split()[-2:]]
            found[n] = errors[0]
            limits = LIMITS.get((shape, n), (None, None))
            for what, error, limit in zip(QUANTITIES, errors, limits, strict=True):
                yield Row("vortex", shape, 1 / n, 1, what, error, 0.0, error, limit, cpu)
        if shape == "gimp":
            for coarse, limit in ((8, 0.1), (16, 0.2)):
                order = math.log2(found[coarse] / found[2 * coarse])
                yield Row(
                    "vortex", shape, 0.5 / coarse, 1, "order", order, 2.0,
                    max(0.0, (2 - order) / 2), limit, 0.0,
                )  # fmt: skip
