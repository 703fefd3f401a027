"""Progress bars on long work: on a terminal, after half a second, never in a file."""

from tqdm import tqdm


def progress(items, text, total=None):
    """Go through items under a bar."""
    return tqdm(items, desc=text, total=total, delay=0.5, leave=False, disable=None)
