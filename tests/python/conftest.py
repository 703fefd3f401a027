"""The packages verify and bench stand beside this folder, xmpm_prep in preproc."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "preproc"))
