"""The examples with cracks made from their geometry, ready to run.

    .venv/bin/python input/prepare.py [EXAMPLE ...] [-o FOLDER] [--coarse | --full | --h SIZE]

For each example (all where none is named) a folder is made with the crack files that `xmpm-prep
crack` makes of input/geometry/EXAMPLE.geo, and with the deck input/EXAMPLE.inp that reads them:

    cd results/examples/rod-quarter && mpirun -n 2 ../../../build/release/bin/xmpm3d rod-quarter.inp

The decks in input/ have the same cracks as shapes of their own, and run without any of this.
"""

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
STEPS = 5  # of a coarse run


@dataclass(frozen=True)
class Example:
    """Names of the cracks, and edges of the cells: everyday, coarse, of the paper [mm]."""

    cracks: tuple[str, ...]
    h: float
    coarse: float
    full: float
    fine: float = 1.0  # triangles in the edge of a cell


EXAMPLES = {
    "plate-1": Example(("slit-1",), 2.0, 4.0, 2.0),
    "plate-2": Example(("slit-1", "slit-2"), 2.0, 4.0, 2.0),
    "plate-4": Example(("slit-1", "slit-2", "slit-3", "slit-4"), 2.0, 4.0, 2.0),
    "cylinder-penny": Example(("penny",), 2.0, 5.0, 1.0),
    "ellipse-bar": Example(("flaw",), 5.0, 10.0, 2.5, 2.0),
    "bending-2mm": Example(("notch",), 2.0, 5.0, 1.0),
    "bending-5mm": Example(("notch",), 2.0, 5.0, 1.0),
    "bending-eccentric": Example(("notch",), 2.0, 5.0, 1.0),
    "rod-quarter": Example(("corner",), 2.0, 5.0, 1.0),
    "tube-crack": Example(("slit",), 2.0, 5.0, 1.0),
}


def prepare(name, folder, h, coarse=False):
    """Make the crack files and the deck of an example in a folder; the cracks by their names."""
    from xmpm_prep.crack_file import write_crack
    from xmpm_prep.crack_make import Wish, make_crack

    example = EXAMPLES[name]
    folder.mkdir(parents=True, exist_ok=True)
    cracks = {}
    for crack in example.cracks:
        size = h / example.fine
        wish = Wish(HERE / "geometry" / f"{name}.geo", size, h, name=crack, unit="mm")
        cracks[crack] = made = make_crack(wish)
        write_crack(folder / f"{crack}.h5", made.surface, made.fronts, made.unit)
    deck = (HERE / f"{name}.inp").read_text(encoding="utf-8")
    (folder / f"{name}.inp").write_text(change_deck(deck, h, coarse), encoding="utf-8")
    return cracks


def change_deck(deck, h, coarse):
    """A deck with another size of cells, cracks from files and, if coarse, a few steps only."""
    deck = replace_once(r"(?m)^  h = [0-9.]+", f"  h = {h:g}", deck)
    deck = re.sub(
        r"(?m)^\*CRACK (\S+).*\n(?:(?!\*|  ramp|  contact).*\n)+",
        lambda block: f'*CRACK {block[1]}\n  file = "{block[1]}.h5"\n',
        deck,
    )
    if coarse:
        deck = replace_once(r"(?m)^\*TIME ", f"*TIME steps = {STEPS}, ", deck)
    return deck


def replace_once(pattern, text, deck):
    """A replacement that must find its place."""
    deck, count = re.subn(pattern, text, deck)
    if count != 1:
        raise SystemExit(f"prepare: the deck has {count} places for '{text}'")
    return deck


def main(arguments=None):
    """Prepare the examples that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help=", ".join(EXAMPLES))
    parser.add_argument("-o", "--output", metavar="FOLDER", type=Path)
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--coarse", action="store_true", help="large cells and a few steps")
    sizes.add_argument("--full", action="store_true", help="the paper's cells")
    sizes.add_argument("--h", type=float, help="edge of the cells [mm]")
    options = parser.parse_args(arguments)
    for name in options.examples:
        if name not in EXAMPLES:
            parser.error(f"there is no example '{name}'; there are: {', '.join(EXAMPLES)}")
    from xmpm_prep.errors import PrepError

    output = options.output or HERE.parent / "results" / "examples"
    for name in options.examples or EXAMPLES:
        example = EXAMPLES[name]
        h = example.coarse if options.coarse else example.full if options.full else example.h
        try:
            cracks = prepare(name, output / name, options.h or h, options.coarse)
        except PrepError as failure:
            print(f"prepare: {name}: {failure}", file=sys.stderr)
            return failure.code
        print(f"{output / name / name}.inp")
        for crack, made in cracks.items():
            lengths = ", ".join(f"{front.length:.4g}" for front in made.fronts)
            print(
                f"   crack {crack}: {len(made.surface.triangles)} triangles, "
                f"fronts of {lengths or 'no'} mm"
            )
    return 0


if __name__ == "__main__":
    sys.path.insert(0, str(HERE.parent / "preproc"))
    sys.exit(main())
