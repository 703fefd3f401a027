"""What the domain integrals make of exact fields that are put on particles.

The static penny under tension and the tip that moves at 0, 0.3 and 0.6 of the Rayleigh speed, so
that nothing but the integral itself is at fault; and the functions A_M of the front's speed. The
numbers come from a small program (tests/verify/exact_field.f90) that shares its fields with the
unit tests; it stands beside the program. h is the cell size over the crack's radius (penny) or over
the radius of the domain (straight front).
"""

import csv
import os
from collections.abc import Iterator
from pathlib import Path

from verify import Row, RunError
from verify.measure import ROOT, run_command


def rows(full: bool) -> Iterator[Row]:
    """K from J over the exact one, its order in h, and the largest error of A_M."""
    program = Path(os.environ["XMPM3D"]).parent / "exact_field"
    folder = ROOT / "build" / "runs"
    folder.mkdir(parents=True, exist_ok=True)
    if not program.is_file():
        raise RunError(f"{program} is missing; it is built with the tests")
    code, _, _, _, text = run_command([str(program)], folder, None, 600.0)
    if code != 0:
        raise RunError(f"{program} failed:\n{text}")
    for line in csv.DictReader(text.splitlines()):
        yield Row(
            case="exact-field",
            method=line["method"],
            h=float(line["h"]),
            ranks=1,
            quantity=line["quantity"],
            value=float(line["value"]),
            reference=float(line["reference"]),
            error=float(line["error"]),
            limit=float(line["limit"]) if line["limit"] else None,
            cpu_s=float(line["cpu_s"]),
        )
