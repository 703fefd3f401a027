"""Entry of `python -m xmpm_post`."""

import sys

from xmpm_post.cli import main

sys.exit(main())
