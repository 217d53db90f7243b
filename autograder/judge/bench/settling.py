"""Telling that a command has made all its endpoints: its graph has stopped changing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.judge.bench.patience import Patience

if TYPE_CHECKING:
    from autograder.judge.bench import graph


class Settling:
    """Tells when a command's graph has not changed for a while, once there is anything on it.

    Args:
        seconds: As :mod:`autograder.judge.bench.patience` counts them: on a crowded machine a program may have made its
            node, and wait for a processor before it makes what the node is for.
    """

    def __init__(self, seconds: float) -> None:
        self._last: Any = None
        self._patience = Patience(seconds)

    def unchanged(self, interface: graph.Interface, nodes: int) -> bool:
        """True if the graph is as it was ``seconds`` ago, and has nodes at all."""
        state = (nodes, interface)
        if state != self._last:
            self._last = state
            self._patience.restart()
        return nodes > 0 and self._patience.left <= 0
