"""Executing tasks in worker processes. A worker that dies costs only its task, which is tried once more."""

from __future__ import annotations

import contextlib
import os
import queue
import select
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, replace
from typing import IO, TYPE_CHECKING

import msgspec

from autograder.boxes.execution import Execution
from autograder.boxes.processes import end_processes_in
from autograder.boxes.scratch import remove_tree
from autograder.boxes.zero import grader_trouble
from autograder.grading import warmth
from autograder.grading.task import Task, decode_execution, encode
from autograder.grading.worker import JUDGE

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from pathlib import Path

ATTEMPTS = 2
_RESULT_BYTES = 64_000_000
_EXTRA_SECONDS = 60.0
_GOODBYE_SECONDS = 3.0


@dataclass(frozen=True)
class Done:
    """A task that was executed, or could not be."""

    task: Task
    execution: Execution


class WorkerLost(RuntimeError):
    """A worker ended or fell silent; the message says which."""


def execute_all(
    tasks: Sequence[Task],
    scratch: Path,
    workers: int,
    *,
    on_start: Callable[[Task], None] = lambda _: None,
    judge: str = JUDGE,
) -> Generator[Done, None, None]:
    """Execute tasks in parallel; results come as they are ready.

    Leaving the loop early ends every worker and what it runs.

    Args:
        tasks: In the order in which they are begun.
        scratch: Where submissions run; emptied at the end.
        workers: Processes at work at once.
        on_start: Called from a thread when a task is begun.
        judge: What makes a judge, as ``module:class``.
    """
    waiting: queue.SimpleQueue[Task] = queue.SimpleQueue()
    for task in tasks:
        waiting.put(task)
    done: queue.SimpleQueue[Done | BaseException] = queue.SimpleQueue()
    boxed = any(task.boxed for task in tasks)
    lanes = [
        _Lane(waiting, done, scratch / str(number), judge, on_start, boxed)
        for number in range(max(1, min(workers, len(tasks))))
    ]
    try:
        for lane in lanes:
            lane.start()
        for _ in tasks:
            result = done.get()
            if isinstance(result, BaseException):
                raise result
            yield result
    finally:
        for lane in lanes:
            lane.stop()
        deadline = time.monotonic() + _GOODBYE_SECONDS
        for lane in lanes:
            lane.await_end(deadline)
        with contextlib.suppress(OSError):
            remove_tree(scratch)
            scratch.parent.rmdir()


def execute_one(task: Task, scratch: Path, *, judge: str = JUDGE) -> Execution:
    """Execute a single task; for the arguments see :func:`execute_all`."""
    running = execute_all([task], scratch / str(os.getpid()), 1, judge=judge)
    with contextlib.closing(running):
        return next(running).execution


class KeptLane:
    """A worker process that is kept from task to task, for whoever is handed tasks one by one.

    Args:
        scratch: Where submissions run; for this lane alone.
        judge: What makes a judge, as ``module:class``.
        boxed: Whether the tasks to come are executed in boxes.
    """

    def __init__(self, scratch: Path, *, judge: str = JUDGE, boxed: bool = True) -> None:
        self._lane = _Lane(queue.SimpleQueue(), queue.SimpleQueue(), scratch, judge, lambda _: None, boxed)

    def execute(self, task: Task) -> Execution:
        """Execute a task. For one thread at a time."""
        return self._lane._execute(task)

    def stop(self) -> None:
        """End the worker and what it runs, from any thread; a task that is being executed ends with trouble."""
        self._lane.stop()


class _Lane(threading.Thread):
    """One worker process and the thread that speaks with it."""

    def __init__(
        self,
        waiting: queue.SimpleQueue[Task],
        done: queue.SimpleQueue[Done | BaseException],
        scratch: Path,
        judge: str,
        on_start: Callable[[Task], None],
        boxed: bool,
    ) -> None:
        super().__init__(daemon=True)
        self._waiting, self._done = waiting, done
        self._scratch = scratch
        self._command = [sys.executable, "-m", "autograder.grading.worker", str(scratch), judge]
        self._boxed = boxed
        self._on_start = on_start
        # What a worker says on its way down, in a file: a pipe that nobody reads would fill up. Lives with
        # the lane.
        self._log = tempfile.TemporaryFile()  # noqa: SIM115
        self._worker: subprocess.Popen[bytes] | None = None
        self._stopping = False
        self._changing = threading.Lock()

    def run(self) -> None:
        """Take task after task until none is left."""
        try:
            while not self._stopping:
                try:
                    task = self._waiting.get_nowait()
                except queue.Empty:
                    return
                self._on_start(task)
                self._done.put(Done(task, self._execute(task)))
        except BaseException as error:  # the main thread waits for this many results: tell it
            self._done.put(error)
        finally:
            self._end_worker()

    def stop(self) -> None:
        """Ask the worker to end; it ends what it runs. Called from the main thread."""
        with self._changing:
            self._stopping = True
            if self._worker is not None:
                _close(self._worker.stdin)

    def await_end(self, deadline: float) -> None:
        """Wait for the thread, and kill a worker that does not end in time."""
        if self.ident is None:
            return
        self.join(max(0.0, deadline - time.monotonic()))
        with self._changing:
            if self._worker is not None:
                self._worker.kill()
        self.join()

    def _execute(self, task: Task) -> Execution:
        reason = ""
        for _ in range(ATTEMPTS):
            try:
                execution = self._ask(task)
                if execution.trouble:
                    if not warmth.holds(self._boxed):
                        raise WorkerLost(execution.trouble)  # with fresh warm processes it may succeed
                    return replace(execution, trouble=f"{execution.trouble}{self._last_words()}")
                return execution
            except (WorkerLost, OSError, ValueError) as error:
                self._end_worker()
                reason = f"{error}{self._last_words()}"
        verdicts = {i: grader_trouble(cell.check, reason) for i, cell in enumerate(task.cells) if cell.check}
        return Execution(cells=(), verdicts=verdicts, trouble=reason)

    def _last_words(self) -> str:
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").strip().splitlines()
        return f" ({lines[-1][:300]})" if lines else ""

    def _ask(self, task: Task) -> Execution:
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
                addresses = msgspec.json.encode(warmth.addresses(self._boxed)).decode()
                self._worker = subprocess.Popen(
                    [*self._command, addresses],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=self._log,
                    # Ctrl-C goes to the grader, which then ends its workers in good order.
                    start_new_session=True,
                )
            return self._worker

    def _end_worker(self) -> None:
        """End the worker. Only this thread reads from its pipe, so only this thread closes it."""
        worker = self._worker
        if worker is None:
            return
        _close(worker.stdin)
        try:
            worker.wait(_GOODBYE_SECONDS)
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
