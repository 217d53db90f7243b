"""Serve checks: a judge process that has imported everything forks a child for each requested check.

Forking is safe, because the judge process has imported ROS but created no node and no thread. Each check begins with a
new DDS participant, because a new participant discovers the subject at once.
"""

from __future__ import annotations

import contextlib
import selectors
import sys
from typing import TYPE_CHECKING, BinaryIO

import msgspec

from autograder import exercises
from autograder.judge.serving import conversation
from autograder.judge.serving.fork import Child
from autograder.judge.subjects.command import SPARE
from autograder.messages.checks import Refused
from autograder.messages.lines import encode, listen
from autograder.messages.orders import Close, Open, Order, Report
from autograder.standard_output import private_stdout

if TYPE_CHECKING:
    import socket
    from pathlib import Path

REFUSE_LIMIT = 0.5
"""Seconds to wait for a notebook's request before the notebook is refused."""
CLOSE_LIMIT = 10.0
"""Seconds that a check may still take after its cell has ended. The limit is short, because the kernel usually ends
soon after such a cell, and with the kernel the subject.
"""


class JudgeServer:
    """A judge that listens on a Unix socket. If a grader controls it, it runs only checks that the grader opens."""

    def __init__(self, listener: socket.socket, *, controlled: bool) -> None:
        """Prepare to serve on a listening Unix socket; ``controlled`` says whether a grader sends orders."""
        self._controlled = controlled
        self._order: Open | None = None
        self._child: Child | None = None
        self._children: dict[int, Child] = {}
        self._listener = listener

    def serve(self, control: BinaryIO, answers: BinaryIO) -> None:
        """Serve until ``control`` is closed, that is, at most until the process that started the judge ends."""
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ, self._listener)
            selector.register(control, selectors.EVENT_READ, control)
            answers.write(b"ready\n")
            answers.flush()
            while True:
                for key, _ in selector.select(timeout=1.0):
                    if key.fileobj is self._listener:
                        self._accept()
                    elif not self._obey(control, answers):
                        return
                self._reap()

    def _accept(self) -> None:
        connection, _ = self._listener.accept()
        with connection:
            order = self._order
            if self._controlled and (order is None or self._child is not None):
                _refuse(
                    connection,
                    "no check is expected now: each check cell may request its check once, while it is running",
                )
                return
            limit = max(
                (e.limit for e in exercises.unbroken() if order is None or e.id == order.exercise),
                default=REFUSE_LIMIT,
            )
            child = Child(
                lambda: msgspec.json.encode(conversation.converse(connection, order)),
                limit + SPARE,
                close=[self._listener.fileno()],
            )
            if self._controlled:
                self._child = child
            else:
                self._children[child.pid] = child

    def _obey(self, control: BinaryIO, answers: BinaryIO) -> bool:
        """Read and carry out one order of the grader. Return False if the grader has disconnected."""
        line = control.readline()
        if not line:
            return False
        order = msgspec.json.decode(line, type=Order)
        if isinstance(order, Close):
            answers.write(self._close() + b"\n")
        else:
            self._close()
            self._order = order
            answers.write(b"{}\n")
        answers.flush()
        return True

    def _close(self) -> bytes:
        """End the opened check and return its :class:`Report` as JSON, which only the grader decodes."""
        child, self._child, self._order = self._child, None, None
        if child is None:
            return msgspec.json.encode(Report())
        outcome = child.result(within=CLOSE_LIMIT)
        if outcome.hurried:
            # The cell ended before its check did. In that case the notebook gave up and the judge did not fail, so
            # report no trouble.
            return msgspec.json.encode(Report())
        if outcome.data is None or b"\n" in outcome.data:
            trouble = outcome.trouble or "the judge sent more than one report"
            return msgspec.json.encode(Report(trouble=trouble, unfinished=outcome.unfinished))
        return outcome.data

    def _reap(self) -> None:
        """Remove the children that have ended, so that no zombie is left (if no grader controls this judge)."""
        for pid, child in list(self._children.items()):
            if child.done():
                del self._children[pid]


def _refuse(connection: socket.socket, why: str) -> None:
    """Read a request, then refuse it. If the request stayed unread, closing would lose the refusal (unix(7))."""
    with contextlib.suppress(OSError):
        connection.settimeout(REFUSE_LIMIT)
        connection.recv(65536)
        connection.sendall(encode(Refused(why)))


def run(path: Path) -> None:
    """Serve every notebook that connects, until stdin is closed. Redirect everything printed to stderr."""
    answers = private_stdout()
    sys.stdout = sys.stderr
    try:
        JudgeServer(listen(path), controlled=False).serve(sys.stdin.buffer, answers)
    finally:
        path.unlink(missing_ok=True)
