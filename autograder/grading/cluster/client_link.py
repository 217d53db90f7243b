"""The grader's end of the connection to the client process."""

from __future__ import annotations

import contextlib
import queue
import socket
import sys
import threading
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.grading.running.orders import Broken, Command, News
from autograder.messages.lines import Hangup, Lines
from autograder.process_trees import end_soon
from autograder.temporary_folders import unnamed_file
from environment.python_child import python_child

if TYPE_CHECKING:
    from types import TracebackType

_GOODBYE_SECONDS = 1.5


class ClientLink:
    """A running client process. At the end of the ``with`` block, the process is ended.

    Args:
        address: The scheduler's address.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._news: queue.SimpleQueue[News] = queue.SimpleQueue()

    def __enter__(self) -> Self:
        self._log = unnamed_file()
        own, its_own = socket.socketpair()
        self._lines = Lines(own, sys.maxsize)
        # The child starts in this process's folder, because Dask's settings may name certificates by relative paths.
        client = python_child("-m", "autograder.grading.cluster.dask_client", self._address, folder=None)
        self._client = client.start(
            stdin=its_own.fileno(),
            stdout=self._log,
            stderr=self._log,
            start_new_session=True,  # Ctrl-C reaches only the grader, which then ends the client process
        )
        its_own.close()
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the client process; after an error, at once. The scheduler then cancels its tasks."""
        if kind is not None:
            self._client.kill()
        self._lines.finish()
        end_soon(self._client, _GOODBYE_SECONDS)
        self._lines.close()
        self._log.close()

    def say(self, command: Command) -> None:
        """Send a command to the client process. If the process has ended, :meth:`hear` reports that."""
        with contextlib.suppress(Hangup):
            self._lines.say_json(msgspec.json.encode(command))

    def hear(self, within: float | None) -> News | None:
        """Return the next message; None if no message came in time.

        Args:
            within: The number of seconds to wait; None to wait without limit.
        """
        try:
            return self._news.get(timeout=None if within is None else max(0.0, within))
        except queue.Empty:
            return None

    def _listen(self) -> None:
        """Read the client's messages continuously: a client that waits for us to read would not read our commands."""
        try:
            while True:
                self._news.put(msgspec.json.decode(self._lines.hear_json(), type=News))
        except Hangup:
            self._news.put(Broken(f"the client process ended{self._last_words()}"))
        except (msgspec.MsgspecError, ValueError, MemoryError) as error:
            self._news.put(Broken(f"the client process sent an invalid message: {error}"))

    def _last_words(self) -> str:
        with contextlib.suppress(ValueError, OSError):
            self._log.seek(0)
            lines = self._log.read().decode(errors="replace").strip().splitlines()
            return f" ({lines[-1][:300]})" if lines else ""
        return ""
