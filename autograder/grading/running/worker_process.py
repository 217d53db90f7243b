"""A worker process that is kept from task to task, the connection to it, and the fork servers that it uses.

Fork servers are started at their first use and kept until this process ends. So they are started only once for a
batch, and also once for plain ``nbgrader autograde``, which executes one notebook after the other. They end with this
process, however it ends.
"""

from __future__ import annotations

import atexit
import os
import socket
import threading
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.boxes.fork_server import ForkServers
from autograder.execution.cells import Execution
from autograder.grading.running.orders import JUDGE
from autograder.judge.settings import boxed_ros_environment, ros_environment
from autograder.messages.lines import Hangup, Lines, Silent, TooLong
from autograder.process_trees import end_processes_in, end_soon
from autograder.temporary_folders import unnamed_file
from environment.python_child import python_child

if TYPE_CHECKING:
    import subprocess
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses
    from autograder.grading.task import Task

ATTEMPTS = 2
"""The maximum number of times that a task is tried, because a worker may die."""
GOODBYE_SECONDS = 2.0
"""Seconds after which a worker that was asked to end is killed, so that Ctrl-C takes less than three seconds in all."""
_RESULT_BYTES = 64_000_000
_EXTRA_SECONDS = 60.0
_JUDGE_MODULE = "autograder.judge.serving.attached"
_fork_servers: dict[bool, ForkServers] = {}
_changing = threading.Lock()


class WorkerLost(RuntimeError):
    """A worker ended or stopped answering. The message says which."""


class WorkerProcess:
    """A worker process that executes tasks one by one. If it dies, it is started again.

    Args:
        scratch: The folder in which submissions run. No other worker uses it.
        judge: The class that makes a judge, as ``module:class``.
        boxed: True if the first task will be executed in a box.
    """

    def __init__(self, scratch: Path, *, judge: str = JUDGE, boxed: bool = True) -> None:
        self._scratch = scratch
        self._command = ("-m", "autograder.grading.running.worker", str(scratch), judge)
        self._boxed = boxed
        # The worker prints into a file, because a pipe that no process reads would fill up. The file exists as long
        # as the worker.
        self._log = unnamed_file()
        self._worker: subprocess.Popen[bytes] | None = None
        self._lines: Lines | None = None
        self._addresses: Addresses | None = None
        self._stopping = False
        self._changing = threading.Lock()

    def stop(self) -> None:
        """End the worker and what it runs. Any thread may call this. A task in progress ends with trouble."""
        with self._changing:
            self._stopping = True
            if self._lines is not None:
                self._lines.finish()

    @property
    def stopping(self) -> bool:
        """True if the worker was stopped on purpose. Then its failures are ignored."""
        return self._stopping

    def kill(self) -> None:
        """Kill a worker that does not end by itself. Any thread may call this."""
        with self._changing:
            if self._worker is not None:
                self._worker.kill()

    def execute(self, task: Task) -> Execution:
        """Execute a task. Only one thread at a time may call this. Any failure becomes part of the result."""
        reason = ""
        for _ in range(ATTEMPTS):
            try:
                execution = self._ask(task)
                if execution.trouble:
                    if self._is_stale():
                        raise WorkerLost(execution.trouble)  # with new fork servers, the task may succeed
                    return replace(execution, trouble=f"{execution.trouble}{self._last_words()}")
                return execution
            except (WorkerLost, OSError, ValueError) as error:
                self.end()
                reason = f"{error}{self._last_words()}"
        return task.in_trouble(reason)

    def _is_stale(self) -> bool:
        """Return True if the worker has addresses of old fork servers, because another worker has restarted them."""
        holds = _fork_servers_run(self._boxed)
        return not holds or self._addresses != _addresses_of_fork_servers(self._boxed)

    def _last_words(self) -> str:
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").strip().splitlines()
        return f" ({lines[-1][:300]})" if lines else ""

    def _ask(self, task: Task) -> Execution:
        if task.boxed != self._boxed:
            self.end()
            self._boxed = task.boxed
        lines = self._conversation()
        try:
            lines.say_json(msgspec.json.encode(task))
            said = lines.hear_json(task.limits.longest + _EXTRA_SECONDS)
            return msgspec.json.decode(said, type=Execution)
        except Silent as error:
            raise WorkerLost("the grader's worker process did not answer in time") from error
        except TooLong as error:
            raise WorkerLost("the grader's worker process returned too much") from error
        except Hangup as error:
            raise WorkerLost("the grader's worker process ended while it ran this submission") from error
        except msgspec.MsgspecError as error:
            raise WorkerLost(f"the grader's worker process sent an invalid result: {error}") from error

    def _conversation(self) -> Lines:
        """Return the connection to the worker. If the worker does not run, start it."""
        with self._changing:
            if self._stopping:
                raise WorkerLost("the grading run was stopped")
            if self._lines is None:
                self._addresses = _addresses_of_fork_servers(self._boxed)
                addresses = msgspec.json.encode(self._addresses).decode()
                own, its_own = socket.socketpair()
                lines = Lines(own, _RESULT_BYTES)
                with its_own:
                    variables = {**os.environ, **course.variables()}
                    child = python_child(*self._command, addresses, environment=variables)
                    self._worker = child.start(
                        stdin=its_own.fileno(),
                        stdout=self._log,
                        stderr=self._log,
                        # Ctrl-C reaches only the grader, which then ends its workers cleanly.
                        start_new_session=True,
                    )
                self._lines = lines
            return self._lines

    def end(self) -> None:
        """End the worker cleanly. Only the thread that executes may call this: only it reads from the worker."""
        worker, lines = self._worker, self._lines
        if worker is None or lines is None:
            return
        lines.finish()
        end_soon(worker, GOODBYE_SECONDS)
        if worker.returncode != 0:
            # The worker may not have cleaned up after itself.
            end_processes_in(self._scratch)
        with self._changing:
            self._worker = self._lines = None
        lines.close()


def _addresses_of_fork_servers(sandbox: bool) -> Addresses:
    """Return the addresses of the fork servers. Those that do not run are started.

    Args:
        sandbox: True to include the fork server for the boxes' supervisors.
    """
    with _changing:
        kept = _fork_servers.get(sandbox)
        if kept is None or not kept.alive:
            if kept is not None:
                kept.stop()
            variables = boxed_ros_environment() if sandbox else ros_environment()
            kept = _fork_servers[sandbox] = ForkServers(
                _JUDGE_MODULE,
                boxed=sandbox,
                environment=variables,
                of_judges=course.variables(),
                interfaces=course.interface_modules(),
            )
        return kept.addresses


def _fork_servers_run(sandbox: bool) -> bool:
    """Return True if every fork server that was started is still running."""
    with _changing:
        kept = _fork_servers.get(sandbox)
        return kept is not None and kept.alive


@atexit.register
def _stop_fork_servers() -> None:
    """End all fork servers, and the processes that they started."""
    with _changing:
        for kept in _fork_servers.values():
            kept.stop()
        _fork_servers.clear()
