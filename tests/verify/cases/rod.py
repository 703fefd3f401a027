"""Square rod with an inclined quarter crack, pulled apart: section 5.3.2 of 10.1002/nme.6653.

The crack begins in mixed mode, K_II/K_I about 0.6, and must turn to mode I: half-way K_II is below
a tenth of K_I, which is a hundredth of G. Its front reaches all sides and locks there, so that none
is left; the surface covers the whole section: it lies over every column of particles. From then on
the halves are free bodies: the momentum of each grows with the load on its end, 400 MPa on 50 x 50
mm, and with nothing else. It is taken from the particles by the side of the crack that they are on,
so that a bond that is left, or a particle on the wrong side, shows; 1 % is what the load itself is
known to, on faces of particles.

The criterion of the largest principal stress also acts on mode III, by the twist of its new rows:
what mode III has of G must fall below a hundredth. The one of the hoop stress does not look at it.
"""

from collections.abc import Iterator

from verify import Row, run_deck
from verify.halves import Body, columns, judge_halves, shipped

SIDE = 50.0


def rows(full: bool) -> Iterator[Row]:
    """The rod at one size, or at three, and with the other criterion."""
    for h in (2.5, 2.0, 1.25) if full else (2.5, 2.0):
        yield from judge(h, "hoop")
    yield from judge(2.5, "schoellmann")


def judge(h: float, criterion: str) -> Iterator[Row]:
    """Rows of a run."""
    run = run_deck(shipped("rod-quarter", h, 0.0525, criterion))
    body = Body("rod", columns(0.0, SIDE, h), section=SIDE**2, mixed=0.6, cut=0.040)
    yield from judge_halves(body, run, criterion, h)
