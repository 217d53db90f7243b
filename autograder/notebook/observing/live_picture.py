"""Keeps a picture below a cell up to date, in a background thread with a hidden node."""

from __future__ import annotations

import base64
import contextlib
import contextvars
import threading
import time
from html import escape
from typing import TYPE_CHECKING, Any, Protocol

from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException

from autograder.notebook.cell_output import notebook_shell
from autograder.notebook.checking.card_display import is_live
from autograder.notebook.observing.ros_graph import hidden_node

if TYPE_CHECKING:
    from rclpy.node import Node

_GONE = (InvalidHandle, RCLError, NotInitializedException, ExternalShutdownException)
"""The errors that a node's methods raise if the node was destroyed or ROS was shut down."""


def svg_page(width: float, height: float, head: str, style: str, body: str) -> str:
    """Return an SVG picture with a title, a style and a background.

    Args:
        width: The width in pixels.
        height: The height in pixels.
        head: The SVG elements for the title and, if there is one, the description.
        style: The CSS of the picture.
        body: The SVG elements in front of the background.
    """
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}">{head}<style>{style}</style>'
        f'<rect class="ground" width="100%" height="100%" rx="6"/>{body}</svg>'
    )


def as_image(svg: str, words: str, attributes: str = "") -> str:
    """Return a picture as an ``img`` element with a data URL.

    The picture is not embedded as an SVG element, because JupyterLab removes such elements from untrusted output.

    Args:
        svg: The picture as SVG.
        words: The picture in words, for readers who cannot see it.
        attributes: More HTML attributes for the ``img`` element.
    """
    data = base64.b64encode(svg.encode()).decode()
    more = f" {attributes}" if attributes else ""
    return f'<img{more} alt="{escape(words)}" src="data:image/svg+xml;base64,{data}">'


class _Pictures(Protocol):
    """The source of the pictures that a :class:`LivePicture` shows one after the other."""

    name: str
    """The name of the hidden node. It begins with an underscore, so that ROS hides the node."""
    period: float
    """Seconds between two updates."""

    def first(self) -> Any:
        """Return the first picture."""

    def next(self, node: Node) -> Any:
        """Return the next picture; None if nothing has changed."""

    def last(self) -> Any:
        """Return the picture to show at the end; None to keep the one that is shown."""


class LivePicture:
    """A picture that is kept up to date in the background.

    Updating ends when the time is over, when the cell is run again, when another picture with the same name begins,
    when the kernel's nodes are stopped, or when ROS is shut down. The last picture stays.

    Args:
        pictures: The pictures to show.
        minutes: The number of minutes after which updating ends.

    Raises:
        ValueError: ``minutes`` is not a positive number.
    """

    def __init__(self, pictures: _Pictures, minutes: float) -> None:
        if not minutes > 0:
            raise ValueError(f"minutes must be a positive number, such as 10, not {minutes!r}")
        self._pictures = pictures
        self._minutes = minutes
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        self._handle: Any = None

    @property
    def running(self) -> bool:
        """True while the picture is kept up to date."""
        return self._thread is not None and self._thread.is_alive()

    def start(self) -> None:
        """Show the first picture and keep it up to date. In a grader's kernel, only show the first picture."""
        from IPython.display import display

        picture = self._pictures.first()
        if notebook_shell() is None:
            print(picture)
            return
        self._handle = display(picture, display_id=True)  # type: ignore[no-untyped-call]
        if is_live():
            # Make the node in the cell's thread, so that it belongs to this run of the cell and is destroyed before the
            # next.
            node = hidden_node(self._pictures.name)
            here = contextvars.copy_context()
            self._thread = threading.Thread(
                target=here.run, args=(self._go_on, node), name=self._pictures.name, daemon=True
            )
            self._thread.start()

    def stop(self) -> None:
        """Stop updating. The last picture stays."""
        self._over.set()
        if self._thread is not None:
            self._thread.join()

    def _go_on(self, node: Node) -> None:
        end = time.monotonic() + 60 * self._minutes
        with contextlib.suppress(*_GONE):
            while not self._over.wait(self._pictures.period) and time.monotonic() < end:
                self._show(self._pictures.next(node))
            node.destroy_node()
        self._show(self._pictures.last())

    def _show(self, picture: Any) -> None:
        if picture is not None:
            self._handle.update(picture)

    def __repr__(self) -> str:
        """Return the line that a notebook shows if this is the last expression of a cell."""
        if self.running:
            return f"The picture is kept up to date for {self._minutes:g} minutes. .stop() ends it."
        return "The picture is no longer kept up to date: run the cell again."
