"""A worker process that is kept from task to task, and the conversation with it."""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import replace
from typing import IO, TYPE_CHECKING

import msgspec

from autograder.boxes.execution import Execution
from autograder.boxes.verdicts_without_judge import grader_trouble
from autograder.grading.running import shared_fork_servers
from autograder.grading.running.worker import JUDGE
from autograder.grading.task import Task, decode_execution, encode
from autograder.process_trees import end_processes_in

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses

ATTEMPTS = 2
"""The number of times that a task is tried: a second time where its worker died."""
GOODBYE_SECONDS = 2.0
"""Seconds after which a worker that was asked to end is killed, so that Ctrl-C takes less than three in all."""
_RESULT_BYTES = 64_000_000
_EXTRA_SECONDS = 60.0


class WorkerLost(RuntimeError):
    """A worker ended or fell silent; the message says which."""


class WorkerProcess:
    """One worker process, for tasks one by one; started again when it dies.

    Args:
        scratch: Where submissions run; for this worker alone.
        judge: What makes a judge, as ``module:class``.
        boxed: Whether the first task will be executed in a box.
    """

    def __init__(self, scratch: Path, *, judge: str = JUDGE, boxed: bool = True) -> None:
        self._scratch = scratch
        self._command = [sys.executable, "-m", "autograder.grading.running.worker", str(scratch), judge]
        self._boxed = boxed
        # Standard error of the worker goes to a file: a pipe that nobody reads would fill up. Lives with
        # the worker.
        self._log = tempfile.TemporaryFile()  # noqa: SIM115
        self._worker: subprocess.Popen[bytes] | None = None
        self._addresses: Addresses | None = None
        self._stopping = False
        self._changing = threading.Lock()

    def stop(self) -> None:
        """End the worker and what it runs, from any thread; a task that is being executed ends with trouble."""
        with self._changing:
            self._stopping = True
            if self._worker is not None:
                _close(self._worker.stdin)

    @property
    def stopping(self) -> bool:
        """True if it was stopped: then trouble says nothing."""
        return self._stopping

    def kill(self) -> None:
        """End a worker that does not end by itself, from any thread."""
        with self._changing:
            if self._worker is not None:
                self._worker.kill()

    def execute(self, task: Task) -> Execution:
        """Execute a task. For one thread at a time; whatever goes wrong is in the result."""
        reason = ""
        for _ in range(ATTEMPTS):
            try:
                execution = self._ask(task)
                if execution.trouble:
                    if self._is_stale():
                        raise WorkerLost(execution.trouble)  # with fresh fork servers it may succeed
                    return replace(execution, trouble=f"{execution.trouble}{self._last_words()}")
                return execution
            except (WorkerLost, OSError, ValueError) as error:
                self.end()
                reason = f"{error}{self._last_words()}"
        verdicts = {i: grader_trouble(cell.check, reason) for i, cell in enumerate(task.cells) if cell.check}
        return Execution(cells=(), verdicts=verdicts, trouble=reason)

    def _is_stale(self) -> bool:
        """True if the worker knows other fork servers than there are: another worker may have started them anew."""
        holds = shared_fork_servers.holds(self._boxed)
        return not holds or self._addresses != shared_fork_servers.addresses(self._boxed)

    def _last_words(self) -> str:
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").strip().splitlines()
        return f" ({lines[-1][:300]})" if lines else ""

    def _ask(self, task: Task) -> Execution:
        if task.boxed != self._boxed:
            self.end()
            self._boxed = task.boxed
        worker = self._running_worker()
        assert worker.stdin is not None
        assert worker.stdout is not None
        worker.stdin.write(encode(task) + b"\n")
        worker.stdin.flush()
        limits = task.limits
        within = limits.start_seconds + limits.notebook_seconds + limits.interrupt_grace + _EXTRA_SECONDS
        line = _read_line(worker.stdout.fileno(), time.monotonic() + within)
        try:
            return decode_execution(line)
        except msgspec.MsgspecError as error:
            raise WorkerLost(
                f"the grader's worker process said something else than a result: {error}"
            ) from error

    def _running_worker(self) -> subprocess.Popen[bytes]:
        with self._changing:
            if self._stopping:
                raise WorkerLost("the grading run was stopped")
            if self._worker is None:
                self._addresses = shared_fork_servers.addresses(self._boxed)
                addresses = msgspec.json.encode(self._addresses).decode()
                self._worker = subprocess.Popen(
                    [*self._command, addresses],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=self._log,
                    # Ctrl-C goes to the grader, which then ends its workers in good order.
                    start_new_session=True,
                )
            return self._worker

    def end(self) -> None:
        """End the worker in good order. Only for the thread that executes: it alone reads from its pipe."""
        worker = self._worker
        if worker is None:
            return
        _close(worker.stdin)
        try:
            worker.wait(GOODBYE_SECONDS)
        except subprocess.TimeoutExpired:
            worker.kill()
            worker.wait()
        if worker.returncode != 0:
            # It may not have come to tidying up after itself.
            end_processes_in(self._scratch)
        with self._changing:
            self._worker = None
        _close(worker.stdout)


def _close(pipe: IO[bytes] | None) -> None:
    with contextlib.suppress(OSError):
        assert pipe is not None
        pipe.close()


def _read_line(descriptor: int, deadline: float) -> bytes:
    """One line from a pipe.

    Raises:
        WorkerLost: The pipe was closed, or the deadline passed.
    """
    pieces: list[bytes] = []
    size = 0
    while True:
        ready, _, _ = select.select([descriptor], [], [], max(0.0, deadline - time.monotonic()))
        if not ready:
            raise WorkerLost("the grader's worker process did not answer in time")
        piece = os.read(descriptor, 1 << 16)
        if not piece:
            raise WorkerLost("the grader's worker process ended while it ran this submission")
        pieces.append(piece)
        size += len(piece)
        if piece.endswith(b"\n"):
            return b"".join(pieces)
        if size > _RESULT_BYTES:
            raise WorkerLost("the grader's worker process returned too much")
