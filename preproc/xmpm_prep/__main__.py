"""`python -m xmpm_prep` is `xmpm-prep`."""

import sys

from xmpm_prep.cli import main

sys.exit(main())
