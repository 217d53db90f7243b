"""Hard links as a student makes them: later than the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def hard_link(path: Path, to: Path) -> None:
    """Give a file a second name, in a folder that changes later than the file's own folder.

    The grader tells the first name from the second by these times, which Linux counts in ticks of some milliseconds.
    """
    path.hardlink_to(to)
    while path.parent.stat().st_ctime_ns <= to.parent.stat().st_ctime_ns:
        path.unlink()
        path.hardlink_to(to)
