"""Words to the student, from whichever thread."""

from __future__ import annotations

from contextlib import suppress


def say(text: str) -> None:
    """Print under the cell that runs, or that ran last.

    On standard output: stock nbgrader gives no points to a graded cell with anything on standard error.
    """
    # A kernel that is ending has closed its streams: nobody is left to read it.
    with suppress(OSError, ValueError):
        print(text, flush=True)
