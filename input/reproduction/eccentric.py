"""5.3.1, eccentric: the crack turns to the punch.

The beam of the centred case, hit 20 mm to the left of the crack (figures 21 and 22). There are no
printed numbers: the path must turn to the punch, x = -20 mm at the top, and converge with the
cells of 4, 2 and 1 mm.
"""

from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np

from reproduction.study import Done, Result, Study
from verify.bending import distance, path_of
from xmpm_post import style

DIFFERS = """
As in the centred case the paper leaves the punch open; 2 mm is its half-width here. Figure 22 has
no printed numbers, so the paths are compared with each other: the largest distance of the path of
a size from that of the next finer one, over the length that both have.
"""
SIZES = {"coarse": (5.0, 4.0), "everyday": (4.0, 2.0), "full": (4.0, 2.0, 1.0)}


def reproduce(study: Study) -> Iterator[Result]:
    """Where the paths end and how far they lie apart; figure 22."""
    runs = [study.run("bending-eccentric", h) for h in SIZES[study.size]]
    paths = [path_of(done.results) for done in runs]
    for done, path in zip(runs, paths, strict=True):
        turn = np.rad2deg(np.arctan2(-(path[-1, 0] - path[0, 0]), path[-1, 1] - path[0, 1]))
        yield study.result(done, "mean angle of the path to the punch [degrees]", turn)
    for i, done in enumerate(runs[:-1]):
        apart = distance(paths[i], paths[i + 1])
        yield study.result(done, f"path from that of h = {runs[i + 1].h:g} mm [mm]; error: cells",
                           apart, 0.0, "convergence", apart / done.h)  # fmt: skip
    draw(study, runs, paths)


def draw(study: Study, runs: list[Done], paths: list[np.ndarray]) -> None:
    """Figure 22: the paths."""
    with plt.rc_context(style.LOOK):
        figure, (panel,) = style.panels(1, height=3.0)
        for done, path, (colour, marker) in zip(runs, paths, style.looks(), strict=False):
            panel.plot(*path[:, :2].T, marker, ls="-", ms=2, color=colour, label=f"{done.h:g} mm")
        panel.plot([-22, -18], [100, 100], "k", lw=3, solid_capstyle="butt")
        panel.axhline(100, color="0.7", lw=0.5, zorder=0)
        panel.set(xlabel="$x$ [mm]", ylabel="$y$ [mm]; bar: punch", xlim=(-32, 8), ylim=(46, 104))
        panel.set_aspect("equal")
        panel.legend(title="cells")
        style.save(figure, study.picture("paths"))
