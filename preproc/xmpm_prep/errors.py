"""The one error that users see."""

import sys

USAGE = 2  # wrong options, or a model that cannot be used
FILES = 4  # a file that cannot be read or written


class PrepError(Exception):
    """Ends a command: one clear line that says where, what, and what is allowed.

    The exit codes are those of xmpm3d: 2 for options and models, 4 for files.
    """

    def __init__(self, message, code=USAGE):
        super().__init__(" ".join(str(message).split()))
        self.code = code


def warn(message):
    """Say what may be a mistake, and go on."""
    print(f"xmpm-prep: warning: {' '.join(message.split())}", file=sys.stderr)


def doubt(message, force):
    """An error, or with --force a warning: what is nearly always a mistake but may be meant."""
    if not force:
        raise PrepError(f"{message} (if it is meant so: --force)")
    warn(message)
