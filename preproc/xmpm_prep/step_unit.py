"""The unit of length that a STEP file states in its text."""

import re

PREFIXES = {"MILLI": "mm", "CENTI": "cm", "MICRO": "um", "KILO": "km", None: "m"}
NAMES = {"INCH": "in", "FOOT": "ft", "METRE": "m", "MILLIMETRE": "mm", "CENTIMETRE": "cm"}


def step_unit(path):
    """Word for the unit as in the deck, None where the file does not say or says more than one."""
    text = path.read_text(encoding="latin-1")
    found = set()
    based = set()
    for name in re.findall(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", text):
        if name.upper() in NAMES:
            based.add(NAMES[name.upper()])
    for prefix in re.findall(r"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.", text):
        found.add(PREFIXES.get(prefix or None))
    units = based or found  # an inch is stated by way of a millimetre
    return units.pop() if len(units) == 1 else None
