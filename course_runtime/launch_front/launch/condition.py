"""The base of all conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from .launch_context import LaunchContext


class Condition:
    """Decides whether an action happens."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if the condition holds now."""
        return self._predicate is None or self._predicate(context)
