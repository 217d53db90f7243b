"""A picture below a cell that is drawn again from time to time, by a thread and a hidden node of its own."""

from __future__ import annotations

import contextlib
import contextvars
import threading
import time
from typing import TYPE_CHECKING, Any, Protocol

from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException

from autograder.notebook.cells.cell_output import notebook_shell
from autograder.notebook.checking.card_display import is_live
from autograder.notebook.observing.ros_graph import hidden_node

if TYPE_CHECKING:
    from rclpy.node import Node

GONE = (InvalidHandle, RCLError, NotInitializedException, ExternalShutdownException)
"""The errors of a node's methods where the node was destroyed or ROS was shut down meanwhile."""


class Pictures(Protocol):
    """The pictures to be shown."""

    name: str
    """Of the node that looks; names that begin with an underscore are hidden in ROS."""
    period: float
    """Seconds between two looks."""

    def first(self) -> Any:
        """The first picture."""

    def next(self, node: Node) -> Any:
        """The next picture; None where nothing has changed."""

    def last(self) -> Any:
        """The picture that stays at the end; None where that is what is shown."""


class LivePicture:
    """A picture that is kept up to date in the background.

    It ends by itself after a while, when its cell is run again, when another of its kind begins, when everything is
    stopped or ROS is shut down. What was seen last stays.

    Args:
        pictures: What is to be seen.
        minutes: How long it goes on at most.

    Raises:
        ValueError: ``minutes`` is not a positive number.
    """

    def __init__(self, pictures: Pictures, minutes: float) -> None:
        if not minutes > 0:
            raise ValueError(
                f"minutes is how long the picture is kept up to date, such as 10, not {minutes!r}"
            )
        self._pictures = pictures
        self._minutes = minutes
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        self._handle: Any = None

    @property
    def running(self) -> bool:
        """True if the picture is still kept up to date."""
        return self._thread is not None and self._thread.is_alive()

    def start(self) -> None:
        """Show the first picture and begin; where nobody looks, as while a class is graded, that is all."""
        from IPython.display import display

        picture = self._pictures.first()
        if notebook_shell() is None:
            print(picture)
            return
        self._handle = display(picture, display_id=True)  # type: ignore[no-untyped-call]
        if is_live():
            # Made in the cell's own thread: it belongs to this run of the cell, and ends with it.
            node = hidden_node(self._pictures.name)
            here = contextvars.copy_context()
            self._thread = threading.Thread(
                target=here.run, args=(self._go_on, node), name=self._pictures.name, daemon=True
            )
            self._thread.start()

    def stop(self) -> None:
        """End it; the last picture stays."""
        self._over.set()
        if self._thread is not None:
            self._thread.join()

    def _go_on(self, node: Node) -> None:
        end = time.monotonic() + 60 * self._minutes
        with contextlib.suppress(*GONE):
            while not self._over.wait(self._pictures.period) and time.monotonic() < end:
                self._show(self._pictures.next(node))
            node.destroy_node()
        self._show(self._pictures.last())

    def _show(self, picture: Any) -> None:
        if picture is not None:
            self._handle.update(picture)

    def __repr__(self) -> str:
        """One line for the end of a cell."""
        if self.running:
            return f"The picture is kept up to date for {self._minutes:g} minutes. .stop() ends it."
        return "The picture is no longer kept up to date: run the cell again."
