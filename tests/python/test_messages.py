"""Every message of an error in the sources is expected, word by word, by some test.

A message is the texts in a call that reports an error. It counts as expected where a text in a test
holds a whole part of it of eight letters at least, or where half of that text at least, and twelve
letters, stand in one part of it in a row and no more of it in any other message.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REPORTERS = r"\bcall (raise|complain|blame|refuse|note_problem|note|warn)\s*\("
TEXT = re.compile(r"'((?:[^'\n]|'')*)'|\"((?:[^\"\n]|\"\")*)\"")
WHOLE, RUN = 8, 12  # letters

#: Messages that no test can provoke without a fault of the machine, by a part of theirs.
UNPROVOKED = {
    "the file cannot be closed (disk full?)": "a disk that is full at that moment",
    "cannot write the dataset ": "a disk that is full at that moment",
    "cannot write the attribute ": "a disk that is full at that moment",
    ": cannot be read": "a file that cannot be read after it could be opened",
    "METIS could not divide ": "a failure inside METIS",
}


def without_comment(line: str) -> str:
    """Line of Fortran up to the ! of a comment."""
    quote = ""
    for place, letter in enumerate(line):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter == "!":
            return line[:place]
    return line


def statements(path: Path) -> Iterator[tuple[int, str]]:
    """Statements of a Fortran file with the number of their first line."""
    joined, first = "", 0
    for number, line in enumerate(path.read_text().splitlines(), 1):
        code = without_comment(line).strip()
        if not joined:
            first = number
        joined += code.removeprefix("&").lstrip()
        if joined.endswith("&"):
            joined = joined[:-1].rstrip() + " "
        elif joined:
            # Texts that // joins are one.
            yield first, re.sub(r"'\s*//\s*'", "", joined)
            joined = ""


def texts(code: str) -> list[str]:
    """Texts in quotes."""
    found = TEXT.finditer(code)
    return [m[1].replace("''", "'") if m[1] is not None else m[2].replace('""', '"') for m in found]


def messages() -> dict[str, list[str]]:
    """Parts of all messages by the place of their call."""
    found = {}
    for path in sorted((ROOT / "src").glob("*/*.f90")):
        for number, code in statements(path):
            call = re.search(REPORTERS, code)
            parts = [t for t in texts(code[call.end() :]) if " " in t.strip()] if call else []
            if parts:
                found[f"{path.relative_to(ROOT)}:{number}"] = parts
    return found


def expectations() -> set[str]:
    """All texts of the tests but this one."""
    found = set()
    for path in (ROOT / "tests").glob("**/*"):
        if path.suffix == ".f90":
            found.update(text for _, code in statements(path) for text in texts(code))
        elif path.suffix in (".sh", ".py") and path != Path(__file__):
            found.update(text for line in path.read_text().splitlines() for text in texts(line))
    return {text for text in found if len(text) >= WHOLE}


def longest_run(part: str, text: str) -> int:
    """Most letters in a row that two texts share."""
    best, before = 0, [0] * (len(text) + 1)
    for a in part:
        row = [0] * (len(text) + 1)
        for place, b in enumerate(text, 1):
            if a == b:
                row[place] = before[place - 1] + 1
        best = max(best, *row)
        before = row
    return best


def unexpected(found: dict[str, list[str]], wanted: set[str]) -> list[str]:
    """Places of messages that no text expects."""
    index = defaultdict(set)
    for place, parts in found.items():
        for part in parts:
            for start in range(max(1, len(part) - WHOLE + 1)):
                index[part[start : start + WHOLE]].add(place)
    met = set()
    for text in wanted:
        near = set()
        for start in range(len(text) - WHOLE + 1):
            near |= index.get(text[start : start + WHOLE], set())
        runs = {place: max(longest_run(p, text) for p in found[place]) for place in near}
        met |= {p for p in near if any(len(t) >= WHOLE and t in text for t in found[p])}
        enough = max([RUN, 0.5 * len(text), *runs.values()])
        met |= {place for place, run in runs.items() if run >= enough}
    return [place for place in found if place not in met]


def test_every_message_of_an_error_is_expected_by_a_test():
    found = messages()
    assert len(found) > 200  # they are found at all
    missing = {
        place: found[place]
        for place in unexpected(found, expectations())
        if not any(known in part for known in UNPROVOKED for part in found[place])
    }
    assert not missing


def test_the_messages_that_cannot_be_provoked_are_still_there():
    parts = [part for group in messages().values() for part in group]
    assert [known for known in UNPROVOKED if not any(known in part for part in parts)] == []


def test_a_message_without_a_test_is_found():
    found = {"a.f90:1": ["a wheel came off"], "a.f90:2": ["the radius ", " must be positive"]}
    assert unexpected(found, {"the radius 2 must be positive"}) == ["a.f90:1"]
