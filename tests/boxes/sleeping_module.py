"""What the forks of a test's fork server become: two sleepers that obey nobody."""

from __future__ import annotations

import signal
import subprocess
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def prepare() -> None:
    """Nothing is slow here."""


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Sleep."""
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, signal.SIG_IGN)
    subprocess.Popen(["sleep", "7654.5"], start_new_session=True)
    subprocess.run(["sleep", "7654.5"], check=False)
