"""Results of XMPM3D: read them, draw them.

from xmpm_post import open_run

run = open_run("results/plate-1")
run.energy["kinetic"]                       # columns of NAME_energy.csv
run.front.where(crack="slit", point=3)["K_I"]
run.particles(0.01).fields["stress"]        # the step nearest to t = 0.01
run.crack().fields["opening"]               # the last step
"""

from xmpm_post.errors import PostError
from xmpm_post.run import Run, open_run
from xmpm_post.table import Table
from xmpm_post.vtkhdf import PolyData

__all__ = ["PolyData", "PostError", "Run", "Table", "open_run"]
