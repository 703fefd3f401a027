"""The packages verify and bench stand beside this folder, xmpm_prep and xmpm_post in theirs."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
for name in ("preproc", "postproc"):
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / name))
