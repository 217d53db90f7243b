"""The processes below a process, as Linux lists them."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

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


def halt(roots: Iterable[int], within: float = 3.0) -> list[int]:
    """Stop processes and all below them; none that they start meanwhile escapes.

    Args:
        roots: The uppermost of them.
        within: Seconds after which those who start ever new ones are given up.

    Returns:
        Who was stopped, for :func:`let_go`.

    Raises:
        TimeoutError: They could not be stopped.
    """
    above = set(roots)
    stopped: set[int] = set()
    still = 0
    deadline = time.monotonic() + within
    # Twice, because one that changes its parent while this looks could be seen below neither of them.
    while still < 2:
        running = {*above, *(pid for root in above for pid in descendants(root))} - stopped
        still = 0 if running else still + 1
        for pid in running:
            _send(pid, signal.SIGSTOP)
        stopped |= running
        if time.monotonic() > deadline:
            let_go(stopped)
            raise TimeoutError(
                "processes in the notebook's box go on starting others and could not be stopped"
            )
    return sorted(stopped)


def let_go(pids: Iterable[int]) -> None:
    """Let processes that were stopped go on."""
    for pid in pids:
        _send(pid, signal.SIGCONT)


def _send(pid: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(pid, number)
