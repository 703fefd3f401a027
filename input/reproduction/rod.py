"""5.3.2: square rod with an inclined quarter crack.

A rod of 50 x 50 x 100 mm with a crack at an edge, 18.475 mm along the faces and 60 degrees to the
edge, pulled by 400 MPa at both ends (figure 24). The crack must turn to mode I, reach all sides and
cut the rod through.
"""

from collections.abc import Iterator

from reproduction.study import Result, Study
from reproduction.through import cut_through

DIFFERS = """
With the paper's 100 MPa the crack cannot cross the rod in its 22.5 us: the load of 400 MPa is that
of the original study of this example. Its figure shows the pattern at 22.5 us; here the time at
which the rod is cut through is given.
"""
PRINTED = 22.5  # us, when the front of figure 24 has reached the sides


def reproduce(study: Study) -> Iterator[Result]:
    """When the rod is cut, the modes on the way, and figure 24."""
    yield from cut_through(study, study.run("rod-quarter"), PRINTED)
