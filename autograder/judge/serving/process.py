"""A judge process, seen from the grader: start it, open and close checks, read its verdicts."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol, Self

import msgspec

from autograder import course
from autograder.messages.lines import Hangup, Lines, Silent, listen
from autograder.messages.orders import Close, Open, Report
from autograder.process_trees import signal_group
from environment.python_child import python_child

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

    from autograder.verdict import Verdict

START_LIMIT = 60.0
"""Seconds of wall time in which a judge must be up; it takes well under one on an idle machine."""
ANSWER_LIMIT = 30.0
"""Seconds of wall time in which a judge answers an order."""
_REPORT_BYTES = 64_000_000
"""More than a recorded reference output has, or a verdict with its evidence."""


class JudgeDied(RuntimeError):
    """The judge process is gone or does not answer: nothing can be said about the subject."""


class StartedJudge(Protocol):
    """The process of a judge, wherever it runs."""

    def end(self) -> None:
        """End it with all that it has forked; may be called twice."""
        ...


Start = Callable[[int, int], StartedJudge]
"""Starts a judge on a listening socket and on a connected one for orders; both descriptors stay the caller's."""


class JudgeProcess:
    """A controlled judge. Only what :meth:`close` returns is a grade."""

    def __init__(self, socket_path: Path, *, seed: str, start: Start | None = None) -> None:
        """Name the socket that the kernel will reach the judge on.

        Args:
            socket_path: Unix socket; at most 107 bytes long (unix(7)).
            seed: What the random inputs are drawn from; each exercise draws its own from it.
            start: Starts the process; as a plain child where none is given.
        """
        self.socket_path = socket_path
        self._seed = seed
        self.workspaces = ""
        """The socket of the grader's side of checks of workspaces, as the judge sees it; empty where there is none."""
        self.keeps_evidence = False
        """True if reports carry the evidence of their verdicts."""
        self.is_boxed = False
        """True if it is in a box, beside that of a submission."""
        self._start = start or _Child
        self._process: StartedJudge | None = None
        self._orders: Lines | None = None

    def __enter__(self) -> Self:
        """Start the process and wait until it listens.

        Raises:
            JudgeDied: It did not come up.
        """
        own, its_own = socket.socketpair()
        self._orders = Lines(own, _REPORT_BYTES)
        try:
            with its_own, listen(self.socket_path) as listener:
                self._process = self._start(listener.fileno(), its_own.fileno())
            if self._answer(self._orders, START_LIMIT) != b"ready":
                raise JudgeDied("the judge said something else than that it is ready")
        except (JudgeDied, OSError) as error:
            self.stop()
            raise JudgeDied("the judge did not start; `autograder doctor` says what is missing") from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def open(self, exercise_id: str, *, record: bool = False) -> None:
        """Let the next check of this exercise be answered, once.

        Raises:
            JudgeDied: The judge is gone.
        """
        seed = f"{self._seed}:{exercise_id}"
        self._order(Open(exercise_id, seed, record, self.workspaces, self.keeps_evidence, self.is_boxed))

    def close(self) -> Verdict | None:
        """The verdict of the opened check; None where nobody asked for it or there is none.

        Raises:
            JudgeDied: The judge is gone.
        """
        return self.close_report().verdict

    def close_report(self) -> Report:
        """Like :meth:`close`, with the recorded reference output and the reason why there is no verdict.

        Raises:
            JudgeDied: The judge is gone, or says something else than a report.
        """
        try:
            return msgspec.json.decode(self._order(Close()), type=Report)
        except msgspec.MsgspecError as error:
            raise JudgeDied("the judge says something else than a report") from error

    def stop(self) -> None:
        """End the judge and whatever it has forked."""
        process, self._process = self._process, None
        orders, self._orders = self._orders, None
        if orders is not None:
            orders.close()
        if process is not None:
            process.end()
        self.socket_path.unlink(missing_ok=True)

    def _order(self, order: Open | Close) -> bytes:
        if self._orders is None:
            raise JudgeDied("the judge was never started or is stopped")
        try:
            self._orders.say_json(msgspec.json.encode(order))
        except Hangup as error:
            raise JudgeDied("the judge is gone") from error
        return self._answer(self._orders, ANSWER_LIMIT)

    @staticmethod
    def _answer(orders: Lines, limit: float) -> bytes:
        try:
            return orders.hear_json(limit)
        except Silent as error:
            raise JudgeDied("the judge does not answer") from error
        except Hangup as error:
            raise JudgeDied("the judge is gone") from error


class _Child:
    """A judge as a child of this process."""

    def __init__(self, listener: int, orders: int) -> None:
        words = ("-m", "autograder.judge", "--attached", str(listener), str(orders))
        judge = python_child(*words, environment={**os.environ, **course.variables()})
        self._process = judge.start(
            stdin=subprocess.DEVNULL,
            pass_fds=(listener, orders),
            start_new_session=True,
        )

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    def end(self) -> None:
        """Give it a moment to go by itself: its orders have ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=2.0)
        signal_group(self._process.pid, signal.SIGKILL)
        self._process.wait()
