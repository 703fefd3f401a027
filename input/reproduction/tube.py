"""5.3.3: tube with an inclined crack through its wall.

A tube of 100 mm with radii of 35 and 45 mm and a crack of 14.14 mm at 45 degrees, pulled by 400 MPa
at both ends (figure 26). Both fronts must turn to mode I, run round the tube and meet.
"""

from collections.abc import Iterator

from reproduction.study import Result, Study
from reproduction.through import cut_through

DIFFERS = """
The paper states no load; 400 MPa is that of the rod. Figure 26 has no printed numbers.
The fronts come beside each other 11 mm apart; the deck joins them at 15 mm (`meeting`), else they
pass each other and stop with a tongue of the wall between them.
"""


def reproduce(study: Study) -> Iterator[Result]:
    """When the tube is cut, the modes on the way, and figure 26."""
    yield from cut_through(study, study.run("tube-crack"), None)
