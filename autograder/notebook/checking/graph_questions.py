"""That a subject looks at the graph: told to the judge, which cannot see it from outside.

A subject that looks again and again is waiting for something. Told so, the judge need not let time pass to find out.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, Self

from rclpy.node import Node

if TYPE_CHECKING:
    from collections.abc import Callable
QUESTIONS = ("get_service_names_and_types", "get_service_names_and_types_by_node")
"""The questions to the graph that are told of."""
ENOUGH = 10
"""Looks that are told of in one run; a loop without a pause makes thousands in a second."""


class GraphQuestions:
    """Tells of looks within a ``with`` block."""

    def __init__(self, tell: Callable[[], None], is_subject: Callable[[], bool]) -> None:
        """Prepare.

        Args:
            tell: Called at each look.
            is_subject: Whether the thread that asks is one of the subject's.
        """
        self._tell = tell
        self._is_subject = is_subject
        self._told = 0

    def begin_run(self) -> None:
        """Count from the start."""
        self._told = 0

    def __enter__(self) -> Self:
        self._usual = [(name, getattr(Node, name)) for name in QUESTIONS]
        for name, ask in self._usual:
            setattr(Node, name, self._noticed(ask))
        return self

    def __exit__(self, *_: object) -> None:
        for name, ask in self._usual:
            setattr(Node, name, ask)

    def _noticed(self, ask: Any) -> Any:
        @functools.wraps(ask)
        def asked(*arguments: Any, **options: Any) -> Any:
            answer = ask(*arguments, **options)
            if self._told < ENOUGH and self._is_subject():
                self._told += 1
                self._tell()
            return answer

        return asked
