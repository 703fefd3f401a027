"""5.2.1: cylinder with an inclined penny-shaped crack.

A cylinder of radius 50 mm and length 90 mm with a crack of radius 10 mm, its normal 30 degrees off
the axis, pulled slowly by 40 MPa and damped to rest (figure 15). The reference is eq. 63 to 65, of
a crack in an infinite body; the finite radius adds 0.5 %, which is left in.
"""

from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np

from reproduction.study import Result, Study
from verify.fronts import K, amplitudes, read_front
from verify.solids import penny_k, tension
from xmpm_post import style

DIFFERS = """
The paper runs to 1 s, which would be 1.8 million steps; with damping 1.5 ms is at rest. Its values
lie above theory, which it puts down to a crack that is longer in the grid. That is a part; the
other is its contour integral, which lacks the term out of the plane (eq. 49): on a crack of 10
cells at R = 4 cells that is 7.7 % of K. Here the domain integral has no such term missing, and the
graded jump ends where the crack does.
"""
POISSON, RADIUS, PULL = 0.298, 10.0, 40.0  # mm, MPa
SLOPE = np.deg2rad(30.0)
K_0 = 2 * PULL * np.sqrt(RADIUS / np.pi)
NORMAL = np.array([np.sin(SLOPE), 0.0, np.cos(SLOPE)])
ALONG = np.array([np.cos(SLOPE), 0.0, -np.sin(SLOPE)])


def reproduce(study: Study) -> Iterator[Result]:
    """Amplitudes of the three modes, and figure 15."""
    done = study.run("cylinder-penny", 2.5 if study.size == "everyday" else None)
    front = read_front(done.cost)
    points = front.points[-1]
    stress = tension(PULL, np.array([0.0, 0.0, 1.0]))
    exact = penny_k(stress, NORMAL, np.zeros(3), RADIUS, points, POISSON)
    found = front.k()
    for mode, ratio in enumerate(amplitudes(found, exact)):
        peak = float(np.abs(exact[mode]).max() / K_0)
        yield study.result(done, f"{K[mode]} / K_0, amplitude", ratio * peak, peak, "eq. 63-65")
    worst = float(np.abs(found - exact).max() / K_0)
    yield study.result(done, "largest error of any mode / K_0", worst, 0.0, "eq. 63-65", worst)
    with plt.rc_context(style.LOOK):
        figure, (panel,) = style.panels(1, height=2.6)
        angle = np.rad2deg(np.arctan2(points[:, 1], points @ ALONG)) % 360
        order = np.argsort(angle)
        for mode, (colour, marker) in zip(range(3), style.looks(), strict=False):
            panel.plot(angle[order], exact[mode][order] / K_0, color=colour)
            panel.plot(angle, found[mode] / K_0, marker, color=colour, mfc="white",
                       label=style.label_of(K[mode]))  # fmt: skip
        panel.set(xlabel="angle along the front [degrees]", ylabel="$K / K_0$; lines: eq. 63-65")
        panel.set_ylim(-0.65, 1.15)
        panel.legend(loc="upper center", ncols=3, columnspacing=1.0, handletextpad=0.2)
        style.save(figure, study.picture("front"))
