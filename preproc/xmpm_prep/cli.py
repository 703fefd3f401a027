"""Command line: `xmpm-prep COMMAND ...`; every module of xmpm_prep.commands is a command."""

import argparse
import importlib
import pkgutil
import signal
import sys

from xmpm_prep import __version__, commands
from xmpm_prep.errors import FILES, USAGE, PrepError

HELP = "Make, look at and describe particle files and crack files for XMPM3D."


class Parser(argparse.ArgumentParser):
    """A parser that takes `-60` for a number and gives one line for a wrong option."""

    def error(self, message):
        """End with what is wrong and where to find help."""
        raise PrepError(f"{message}; see: {self.prog} --help", USAGE)


def make_parser():
    """All commands with their options."""
    parser = Parser(prog="xmpm-prep", description=HELP)
    parser.add_argument("--version", action="version", version=f"xmpm-prep {__version__}")
    parser.add_argument("--traceback", action="store_true", help=argparse.SUPPRESS)
    added = parser.add_subparsers(title="commands", dest="command", required=True)
    for module in pkgutil.iter_modules(commands.__path__):
        command = importlib.import_module(f"{commands.__name__}.{module.name}")
        description = command.__doc__
        one = added.add_parser(
            module.name,
            help=command.HELP,
            description=description,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.add_arguments(one)
        one.set_defaults(run=command.run)
    return parser


def main(arguments=None):
    """Run a command; the exit code."""
    try:
        options = make_parser().parse_args(arguments)
    except PrepError as failure:
        return report(failure, failure.code)
    previous = signal.signal(signal.SIGTERM, _interrupt)  # so that temporary files go away
    try:
        return options.run(options) or 0
    except PrepError as failure:
        return report(failure, failure.code)
    except KeyboardInterrupt:
        return report("stopped", 130)
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except MemoryError:
        return report("not enough memory: take a larger --h or fewer particles a cell", USAGE)
    except OSError as failure:
        return report(failure, FILES)
    except Exception as failure:
        if options.traceback:
            raise
        return report(f"this should not happen: {type(failure).__name__}: {failure}", 1)
    finally:
        signal.signal(signal.SIGTERM, previous)


def _interrupt(_number, _frame):
    raise KeyboardInterrupt


def report(failure, code):
    """Say in one line why the command ends."""
    print(f"xmpm-prep: {' '.join(str(failure).split())}", file=sys.stderr)
    return code
