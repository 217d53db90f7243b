"""The processes below a process, as Linux lists them."""

from __future__ import annotations

import ctypes
import os
import signal
from pathlib import Path

_PR_SET_PDEATHSIG = 1


def descendants(pid: int) -> list[int]:
    """Every process that a process has started and these have started, as far as they live."""
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
        children = [int(word) for task in tasks for word in (task / "children").read_text().split()]
    except OSError:
        return []
    return children + [below for child in children for below in descendants(child)]


def arguments_of(pid: int) -> list[str]:
    """The words that a process was started with; none where it is gone."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes().rstrip(b"\0")
    except OSError:
        return []
    return [word.decode("utf-8", "replace") for word in words.split(b"\0")] if words else []


def tell(line: str) -> None:
    """Print a line in one piece: what else writes to the same pipe cannot come between it and its end."""
    os.write(1, f"{line}\n".encode("utf-8", "replace"))


def end_with_the_parent() -> None:
    """Get SIGTERM when the process that started this one is gone; what this one becomes by exec gets it, too."""
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
