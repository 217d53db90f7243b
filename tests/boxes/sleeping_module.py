"""What the forks of a test's fork server become: two sleepers that obey nobody."""

from __future__ import annotations

import os
import signal
import subprocess
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

SLEEP = ["sleep", os.environ["SLEEPERS_SECONDS"]]
"""The number is a test run's own, so that another one beside it does not take these sleepers for its own."""


def prepare() -> None:
    """Nothing is slow here."""


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Sleep."""
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, signal.SIG_IGN)
    subprocess.Popen(SLEEP, start_new_session=True)
    subprocess.run(SLEEP, check=False)
