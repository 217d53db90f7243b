"""The end of a parent: a process can end with it, and can take in the processes that lose theirs.

Both are Linux's alone (prctl(2)); elsewhere nothing is done. Linux takes the *thread* that started a process for its
parent here: it must live as long as the process is wanted.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys

_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_PR_SET_CHILD_SUBREAPER = 36
# Loaded once and here: between a fork and what is executed there nothing can be loaded safely.
_libc = ctypes.CDLL(None, use_errno=True)


def die_with_parent(parent: int = 0, number: signal.Signals = signal.SIGKILL) -> None:
    """Get a signal when the parent ends; be killed where it has ended already.

    What this process becomes by exec gets it too, its children do not. A change of rights takes it away.

    Args:
        parent: Who was the parent before the fork; 0 where it is in another PID namespace or not known, so that one
            which has ended already is not noticed.
        number: What to get.
    """
    _prctl(_PR_SET_PDEATHSIG, number)
    if parent and os.getppid() != parent:
        os._exit(1)


def adopt_orphans() -> bool:
    """Become the parent of every descendant that loses its own, so that none gets out of sight.

    Returns:
        Whether the system can do this; elsewhere than on Linux a daemon may escape.
    """
    return _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def _prctl(option: int, value: int) -> bool:
    if sys.platform != "linux":
        return False
    return bool(_libc.prctl(option, *map(ctypes.c_ulong, (value, 0, 0, 0))) == 0)
