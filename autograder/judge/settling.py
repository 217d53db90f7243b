"""When a command has made all that it makes: nobody says so, its graph only stops changing."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from autograder.judge import graph


class Settling:
    """Tells when a command's graph has not changed for a while, once there is anything on it."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._last: Any = None
        self._since = time.monotonic()

    def unchanged(self, interface: graph.Interface, nodes: int) -> bool:
        """Whether the graph is as it was ``seconds`` ago, and has nodes at all."""
        state = (nodes, interface)
        if state != self._last:
            self._last, self._since = state, time.monotonic()
        return nodes > 0 and time.monotonic() - self._since > self._seconds
