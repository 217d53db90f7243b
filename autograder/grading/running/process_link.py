"""The dispatcher's connection to a process that carries out its commands: the executor process or the Dask client.

Both sides send lines of JSON: the dispatcher sends a ``Command``, the process sends ``News``
(:mod:`autograder.grading.running.worker_messages`).
"""

from __future__ import annotations

import contextlib
import os
import socket
import sys
from typing import TYPE_CHECKING, Self

import msgspec

from autograder import course
from autograder.boxes.visible_host import OVERLAYS
from autograder.grading.running.worker_messages import ADDRESS, Broken, Command, Left, News
from autograder.messages.json_lines import Hangup, Lines, Silent
from autograder.process_trees import end_processes_in, end_soon
from autograder.safe_files import unnamed_file
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

_GOODBYE_SECONDS = 2.0
"""Seconds after which a process that was asked to end is killed, so that Ctrl-C takes less than three seconds."""
_STARTS = 3
"""The maximum number of starts in a row of an executor process that ends without having sent a message."""


class ProcessLink:
    """A process, which starts and ends with the ``with`` block, and the connection to it.

    Args:
        words: The module that the process runs, and the arguments of the module.
        scratch: The folder in which the process executes submissions. If the process ends by accident, it is started
            again. None for a process that only passes messages on, which is not started again, and which keeps the
            caller's working directory, because Dask's settings may name certificates by relative paths.
        overlays: The workspaces that every box of the process sees.
    """

    def __init__(self, *words: str, scratch: Path | None, overlays: Sequence[Path] = ()) -> None:
        self._words, self._scratch = words, scratch
        self._overlays = os.pathsep.join(map(str, overlays))
        self._silent_starts = 0

    def __enter__(self) -> Self:
        # The process prints into a file: a pipe that is not read would fill up and block the process.
        self._log = unnamed_file()
        self._start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        self._log.close()

    def say(self, command: Command) -> None:
        """Send a command. This raises no error if the process has ended: :meth:`hear` then reports its end.

        The process reads commands at any time, even while its own messages wait to be read.
        """
        with contextlib.suppress(Hangup):
            self._lines.say_json(msgspec.json.encode(command))

    def hear(self, within: float | None) -> News | None:
        """Return the next message; None if no message came in time.

        If the process has ended and may be started again, this starts it and returns ``Left``.

        Args:
            within: The number of seconds to wait; None to wait without limit.
        """
        try:
            line = self._lines.hear_json(None if within is None else max(0.0, within))
            news: News = msgspec.json.decode(line, type=News)
        except Silent:
            return None
        except Hangup:
            reason = f"its process ended{self._last_words()}"
        except (msgspec.MsgspecError, ValueError, MemoryError) as error:
            reason = f"the process sent an invalid message: {error}"
        else:
            self._silent_starts = 0
            return news
        if self._silent_starts >= _STARTS or self._scratch is None:
            return Broken(reason)
        self._end()
        self._start()
        return Left(ADDRESS, reason)

    def _start(self) -> None:
        self._silent_starts += 1
        own, its_own = socket.socketpair()
        with its_own:
            child = python_child(
                "-m",
                *self._words,
                environment={**os.environ, **course.variables(), OVERLAYS: self._overlays},
                folder=None if self._scratch is None else "/",
            )
            self._process = child.start(
                stdin=its_own.fileno(),
                stdout=self._log,
                stderr=self._log,
                start_new_session=True,  # Ctrl-C reaches only the grader, which then ends this process
            )
        self._lines = Lines(own, sys.maxsize)

    def _end(self) -> None:
        """Ask the process to end and to clean up, and kill it if it takes too long."""
        self._lines.finish()
        end_soon(self._process, _GOODBYE_SECONDS)
        self._lines.close()
        if self._scratch is not None and self._process.returncode != 0:
            end_processes_in(self._scratch)  # the process may have left processes of submissions

    def _last_words(self) -> str:
        with contextlib.suppress(ValueError, OSError):
            self._log.seek(0)
            lines = self._log.read().decode(errors="replace").strip().splitlines()
            return f" ({lines[-1][:300]})" if lines else ""
        return ""
