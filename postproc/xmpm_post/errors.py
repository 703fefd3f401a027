"""Faults that the user can mend."""


class PostError(Exception):
    """A request that cannot be met; the text is one line that says what is possible."""


def names(values) -> str:
    """Names for a message, in their order."""
    return ", ".join(str(value) for value in values) or "none"
