"""Command line `xmpm-post`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from xmpm_post.errors import PostError
from xmpm_post.run import open_run

FIGURES = ("pdf", "png", "svg")


def parser() -> argparse.ArgumentParser:
    """All commands with their options."""
    top = argparse.ArgumentParser(
        prog="xmpm-post", description="Figures and pictures from the results of XMPM3D."
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    add_k(commands)
    energy = add_command(commands, "energy", "energies and the error of their balance over time")
    add_figure(energy)
    add_crack(commands)
    jump = add_command(commands, "jump", "section through the body and jump across its cracks")
    jump.add_argument("--scale", type=float, help="magnification of the displacements")
    add_picture(jump)
    verify = commands.add_parser(
        "verify", help="error against CPU seconds", description="Error against CPU seconds."
    )
    verify.add_argument(
        "file", nargs="?", type=Path, default=Path("verification.csv"), help="verification.csv"
    )
    verify.add_argument("--cases", nargs="+", metavar="CASE", help="default: all")
    add_figure(verify)
    return top


def add_command(commands, name: str, text: str) -> argparse.ArgumentParser:
    """A command on a run."""
    command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    command.add_argument("run", metavar="NAME", help="FOLDER/NAME of a run, or a folder with one")
    return command


def add_figure(command: argparse.ArgumentParser) -> None:
    """Options of a figure."""
    command.add_argument(
        "-o", "--output", type=Path, help="folder to write to (default: the run's)"
    )
    command.add_argument("--format", choices=FIGURES, default="pdf", help="default: pdf")


def add_picture(command: argparse.ArgumentParser) -> None:
    """Options of a picture."""
    command.add_argument("-o", "--output", type=Path, help="PNG to write (default: beside the run)")
    command.add_argument("--time", type=float, help="the step nearest to this time (default: last)")
    command.add_argument("--renderer", choices=["pyvista", "matplotlib"], help="default: by trial")


def add_k(commands) -> None:
    """Options of `k`."""
    k = add_command(commands, "k", "K and J over time at front points, and along the front")
    k.add_argument("--crack", help="name of the crack (default: the first)")
    k.add_argument("--front", type=int, help="number of its front (default: the first)")
    k.add_argument("--points", type=int, nargs="+", help="numbers of points (default: four)")
    k.add_argument("--times", type=float, nargs="+", help="times along the front (default: three)")
    k.add_argument("--quantities", nargs="+", metavar="COLUMN", help="default: K_I K_II K_III J")
    k.add_argument(
        "--reference", type=Path, nargs="+", default=[], metavar="CSV",
        help="curves with a column time or s and columns of quantities",
    )  # fmt: skip
    add_figure(k)


def add_crack(commands) -> None:
    """Options of `crack`."""
    crack = add_command(commands, "crack", "surfaces and fronts of the cracks")
    crack.add_argument("--field", default="opening", help="colours the surface (default: opening)")
    crack.add_argument("--along", metavar="COLUMN", help="colours the fronts: K_I, J, ...")
    add_picture(crack)


def run_command(given: argparse.Namespace) -> list[str]:
    """Carry out a command; what was written, a line each."""
    if given.command == "verify":
        from xmpm_post.verification import draw_verification

        folder = given.output or given.file.parent
        return draw_verification(given.file, folder, given.format, given.cases)
    run = open_run(given.run)
    if given.command == "k":
        from xmpm_post.fronts import QUANTITIES, draw_k

        return draw_k(
            run, given.output or run.folder, given.format, given.crack, given.front,
            given.points, given.times, tuple(given.quantities or QUANTITIES), given.reference,
        )  # fmt: skip
    if given.command == "energy":
        from xmpm_post.energy import draw_energy

        return draw_energy(run, given.output or run.folder, given.format)
    path = given.output or run.path(f"_{given.command}.png")
    if given.command == "crack":
        from xmpm_post.surface import draw_crack

        return draw_crack(run, path, given.time, given.field, given.along, given.renderer)
    from xmpm_post.jump import draw_jump

    return draw_jump(run, path, given.time, given.scale, given.renderer)


def main(arguments: list[str] | None = None) -> int:
    """Run a command; 2 with one line on standard error where it cannot be met."""
    given = parser().parse_args(arguments)
    try:
        for line in run_command(given):
            print(line)
    except PostError as fault:
        print(f"xmpm-post: {fault}", file=sys.stderr)
        return 2
    return 0
