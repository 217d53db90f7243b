"""Loops of asyncio on paper, each in a thread of the program, which says when it waits."""

from __future__ import annotations

import asyncio
import selectors
import threading
from typing import TYPE_CHECKING, Any

from autograder.authoring.paper.network import Network

if TYPE_CHECKING:
    from collections.abc import Callable


class _PaperLoop(asyncio.SelectorEventLoop):
    """A loop that counts as a running thread only while it has something to do."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._waits = False
        super().__init__(_Selector(self))

    def call_soon_threadsafe(  # type: ignore[override]  # its types are needed by no one here
        self, callback: Callable[..., object], *args: Any, **how: Any
    ) -> asyncio.Handle:
        """Hand a callback to the loop, which runs from this moment on."""
        with self._changing:
            handle = super().call_soon_threadsafe(callback, *args, **how)
            self._runs()
        return handle

    def wait(self, select: Callable[[float | None], list[Any]], timeout: float | None) -> list[Any]:
        """Return the events that have come. If there is none, let the other threads go on until one comes."""
        with self._changing:
            events = select(0)
            if events or timeout == 0:
                return events
            self._waits = True
            Network.now_running.threads.began(-1)
        events = select(timeout)
        with self._changing:
            self._runs()
        return events

    def _runs(self) -> None:
        if self._waits:
            self._waits = False
            Network.now_running.threads.began(1)


class _Selector(selectors.DefaultSelector):
    def __init__(self, loop: _PaperLoop) -> None:
        super().__init__()
        self._loop = loop

    def select(self, timeout: float | None = None) -> list[Any]:
        return self._loop.wait(super().select, timeout)


class PaperLoops(asyncio.DefaultEventLoopPolicy):
    """Makes such loops."""

    _loop_factory = _PaperLoop
