"""A judge process, seen from the grader: start it, open and close checks, read its verdicts."""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import sys
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.judge.protocol import Close, Open, Report

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

    from autograder.verdict import Verdict

START_LIMIT = 60.0
"""Seconds of wall time in which a judge must be up; it takes well under one on an idle machine."""
ANSWER_LIMIT = 30.0
"""Seconds of wall time in which a judge answers an order."""


class JudgeDied(RuntimeError):
    """The judge process is gone or does not answer: nothing can be said about the subject."""


class JudgeProcess:
    """A controlled judge. Only what :meth:`close` returns is a grade."""

    def __init__(self, socket_path: Path, *, seed: str) -> None:
        """Name the socket that the kernel will reach the judge on.

        Args:
            socket_path: Unix socket; at most 107 bytes long (unix(7)).
            seed: What the random inputs are drawn from; each exercise draws its own from it.
        """
        self.socket_path = socket_path
        self._seed = seed
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Self:
        """Start the process and wait until it listens.

        Raises:
            JudgeDied: It did not come up.
        """
        self._process = subprocess.Popen(
            [sys.executable, "-m", "autograder.judge", "--socket", str(self.socket_path), "--controlled"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )
        if self._read(START_LIMIT) != b"ready\n":
            self.stop()
            raise JudgeDied("the judge did not start; `autograder doctor` says what is missing")
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
        self._order(Open(exercise_id, f"{self._seed}:{exercise_id}", record))

    def close(self) -> Verdict | None:
        """The verdict of the opened check; None where nobody asked for it or there is none.

        Raises:
            JudgeDied: The judge is gone.
        """
        return self.close_report().verdict

    def close_report(self) -> Report:
        """Like :meth:`close`, with the recorded reference output and the reason why there is no verdict.

        Raises:
            JudgeDied: The judge is gone.
        """
        return msgspec.json.decode(self._order(Close()), type=Report)

    def stop(self) -> None:
        """End the judge and whatever it has forked."""
        process, self._process = self._process, None
        if process is None:
            return
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                stream.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=2.0)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, 9)
        process.wait()
        self.socket_path.unlink(missing_ok=True)

    def _order(self, order: Open | Close) -> bytes:
        if self._process is None or self._process.stdin is None:
            raise JudgeDied("the judge was never started or is stopped")
        try:
            self._process.stdin.write(msgspec.json.encode(order) + b"\n")
            self._process.stdin.flush()
        except OSError as error:
            raise JudgeDied("the judge is gone") from error
        return self._read(ANSWER_LIMIT)

    def _read(self, limit: float) -> bytes:
        assert self._process is not None
        assert self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], limit)
        line = self._process.stdout.readline() if ready else b""
        if not line:
            raise JudgeDied("the judge does not answer" if not ready else "the judge is gone")
        return line
