"""What an example needs: its size, its runs, its figures."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from prepare import EXAMPLES, change_deck, prepare, replace_once

from verify import Run as Cost
from verify import RunError, run_deck
from xmpm_post import Run, open_run

ROOT = Path(__file__).resolve().parents[2]
SIZES = ("coarse", "everyday", "full")
FAILED = 3  # exit code of a run that gave up: what it did until then is shown
ROOT_MM = 1000**0.5  # K in MPa sqrt(mm) over K in MPa sqrt(m)


@dataclass(frozen=True)
class Result:
    """One compared number."""

    case: str
    size: str  #: coarse, everyday or full
    h: float  #: cell size [mm]
    quantity: str  #: with its unit
    value: float
    reference: float | None  #: None where there is only a value
    error: float | None  #: fraction of the reference, or of what the quantity says
    source: str  #: of the reference
    cpu_s: float  #: of the run behind it, all ranks [s]


@dataclass(frozen=True)
class Done:
    """A finished run."""

    h: float  #: cell size [mm]
    results: Run
    cost: Cost

    @property
    def stopped(self) -> str:
        """Why the run ended early; empty where it did not."""
        found = re.search(r"(?m)^stopped: (.*)", self.cost.text)
        return found[1] if found else ""


@dataclass(frozen=True)
class Study:
    """One example at one size."""

    case: str
    size: str
    ranks: int
    output: Path  #: for figures and tables
    work: Path  #: for runs

    def cells(self, deck: str) -> float:
        """Cell size of a deck at this size [mm]."""
        example = EXAMPLES[deck]
        return {"coarse": example.coarse, "everyday": example.h, "full": example.full}[self.size]

    def run(self, deck: str, h: float | None = None, ranks: int | None = None, **changes) -> Done:
        """Prepare and run a deck of input/, with other keys: `end=0.1` in *TIME is `TIME_end=0.1`.

        A run that gives up counts, with what it wrote; the results say so.
        """
        h = h or self.cells(deck)
        mark = "".join(f"-{key.split('_')[-1]}-{value}" for key, value in changes.items())
        folder = self.work / self.case / f"{deck}-h{h:g}{re.sub('[^A-Za-z0-9.-]+', '_', mark)}"
        text = prepared(deck, folder, h)
        for key, value in changes.items():
            block, name = key.split("_", 1)
            text = change_key(text, block, name, value)
        cost = run_deck(text, ranks=ranks or self.ranks, folder=folder, limit_s=86400, check=False)
        if cost.code not in (0, FAILED):
            raise RunError(f"{folder}: exit code {cost.code}\n{cost.text[-2000:]}")
        return Done(h, open_run(folder / deck), cost)

    def result(
        self,
        done: Done,
        quantity: str,
        value: float,
        reference: float | None = None,
        source: str = "",
        error: float | None = None,
    ) -> Result:
        """Result of a run, with the relative error unless another is given."""
        if done.stopped:
            quantity += f" (run stopped: {done.stopped[:60]})"
        if error is None and reference is not None:
            error = abs(value - reference) / abs(reference)
        return Result(
            self.case, self.size, done.h, quantity, float(value), reference, error, source,
            done.cost.cpu_s,
        )  # fmt: skip

    def picture(self, name: str) -> Path:
        """Path of a figure."""
        mark = "" if self.size == "everyday" else f"-{self.size}"
        return self.output / f"{self.case}-{name}{mark}.png"


def prepared(deck: str, folder: Path, h: float) -> str:
    """A deck of input/ with its cells, and its crack files in the folder."""
    if deck not in EXAMPLES:  # no cracks
        return change_deck((ROOT / "input" / f"{deck}.inp").read_text(encoding="utf-8"), h, False)
    prepare(deck, folder, h)
    return (folder / f"{deck}.inp").read_text(encoding="utf-8")


def change_key(deck: str, block: str, name: str, value: object) -> str:
    """A deck with another value of a key that its only block of that name has or gets."""
    found = re.search(rf"(?m)^\*{block}\b.*\n(?:(?!\*).*\n)*", deck)
    if not found:
        raise KeyError(f"the deck has no *{block}")
    text = found[0]
    if re.search(rf"\b{name} = ", text):
        text = replace_once(rf"\b{name} = [^,!\n]*[^,!\s]", f"{name} = {value}", text)
    else:
        text = re.sub(rf"^\*{block}\b[^!\n]*", rf"\g<0>\n  {name} = {value}", text, count=1)
    return deck[: found.start()] + text + deck[found.end() :]
