"""Entry of `python -m verify`."""

import sys

from verify.driver import main

sys.exit(main())
