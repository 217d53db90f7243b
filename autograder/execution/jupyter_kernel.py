"""Controls a Jupyter kernel, and the desk that reads the kernel's messages. Each of the two is a separate process.

nbclient is made for trusted notebooks: it keeps all output, and learns of a dead kernel from a heartbeat. Here every
wait ends at an answer of the desk, at the end of the kernel's process or at a deadline, whichever comes first.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import select
import signal
import socket
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.admission import NotAdmitted
from autograder.boxes.box_connection import NoSandbox
from autograder.boxes.limit_guards import INTERVAL
from autograder.boxes.run_limits import Ended, wall_time
from autograder.execution.kernel_channels import IOPUB, SHELL, Channels
from autograder.execution.kernel_desk_messages import (
    FURTHER_BYTES,
    MOST_ESCAPED,
    DeskOrder,
    Do,
    Said,
    admitted_answer,
)
from autograder.messages.json_lines import Hangup, Lines, Silent, TooLong

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.boxes.run_limits import Left
    from autograder.execution.executed_cells import NotebookOutputs
    from autograder.execution.kernel_desk_messages import DeskAnswer
    from autograder.execution.notebook_processes import NotebookProcesses


_DESK_SECONDS = 30.0
"""Seconds for a desk to take an order, to end, or to read what an ended kernel has left."""


class KernelFailed(RuntimeError):
    """The kernel did not start or did not answer; the message gives the reason."""


class Kernel:
    """A running kernel.

    Args:
        processes: Starts the processes.
        outputs: Receives the outputs.

    Raises:
        KernelFailed: The process could not be started.
    """

    def __init__(self, processes: NotebookProcesses, outputs: NotebookOutputs) -> None:
        self._limits, self._guard = processes.limits, processes.guard
        self._outputs = outputs
        self._sent = self._answered = -1
        self._cells: set[int] = set()
        self._desk_failed = self._desk_lost = False
        self._log, log = _log_pipe()
        sockets = processes.folder / "kernel"
        sockets.mkdir()
        shell, iopub = (_listener(sockets / f"k-{number}") for number in (SHELL, IOPUB))
        own, orders = socket.socketpair()
        # A desk that a student's message has taken over may stop reading: sending an order must not block forever.
        own.settimeout(_DESK_SECONDS)
        self._desk_says = own
        self._longest = MOST_ESCAPED * self._limits.notebook_output_bytes + FURTHER_BYTES
        self._lines = Lines(own, self._longest)
        given = (shell.fileno(), iopub.fileno(), log, orders.fileno())
        channels = Channels(sockets, secrets.token_hex(32), *given)
        with contextlib.ExitStack() as started:
            started.callback(self._lines.close)
            started.callback(os.close, self._log)
            try:
                self._process = processes.start_kernel(channels)
                started.callback(self._process.end)
                self._desk = processes.start_desk(channels)
            except (OSError, NoSandbox) as error:
                raise KernelFailed(f"the kernel could not be started: {error}") from error
            finally:
                for end in (shell, iopub, orders):
                    end.close()
                os.close(log)
            started.callback(self._desk.end)
            self._open = started.pop_all()

    @property
    def alive(self) -> bool:
        """True if the kernel's process still runs."""
        return self._process.alive

    @property
    def lost(self) -> bool:
        """True if the kernel or the desk ended for a reason outside the notebook, which is then not to blame."""
        return self._process.lost or self._desk_lost

    def await_ready(self) -> None:
        """Wait until the kernel answers and its outputs reach the desk.

        Raises:
            KernelFailed: The kernel ended, or did not answer within ``start_seconds``.
        """
        self._sent = 0
        if self._await_answer(wall_time(self._limits.start_seconds)) is None:
            if self._desk_failed:
                raise KernelFailed("the process that reads the kernel's messages ended while it started")
            if self.alive:
                raise KernelFailed(f"the kernel did not answer within {self._limits.start_seconds:g} s")
            raise KernelFailed(f"the kernel ended while it started: {self._last_words()}")

    def execute(self, cell: int, source: str, left: Left) -> Ended:
        """Execute one cell.

        A cell that is still running at its limit is interrupted; a kernel that does not react is killed.

        Args:
            cell: The index of the cell.
            source: The cell's text.
            left: Returns the seconds that the cell has left.
        """
        if not self.alive:
            return self._died()
        self._cells.add(cell)
        said = self._ask(Do.EXECUTE, left, cell, source)
        if said is None and not self.alive:
            return self._died()
        if said is None or said is Said.FLOODS:
            return self._stopped(Ended.TIMED_OUT if said is None else Ended.TOO_MUCH_OUTPUT)
        if said is Said.EXITS:
            self._process.wait(self._limits.interrupt_grace)
            self.kill()
            return self._died()
        if self._guard.exceeded(at_once=True):
            # The cell ended before the guard saw that a limit was exceeded. End the kernel, as the guard would have
            # done a moment later.
            self.kill()
            return self._died()
        return Ended.DONE if said is Said.DONE else Ended.RAISED

    def kill(self) -> None:
        """End the kernel's process and everything that it started."""
        self._process.end()

    def close(self) -> None:
        """Kill the kernel and its desk, and close the sockets; may be called twice."""
        self._open.close()

    def _stopped(self, why: Ended) -> Ended:
        """Stop the cell that runs, and return how it ended."""
        if why is not Ended.TOO_MUCH_OUTPUT:
            why = self._guard.reason() or why
        self._process.interrupt()  # as JupyterLab's stop button does
        if self._ask(Do.SETTLE, wall_time(self._limits.interrupt_grace)) is None:
            self.kill()
        return Ended.TOO_MUCH_OUTPUT if self._desk_failed else why

    def _died(self) -> Ended:
        """Collect the last outputs of a kernel that has ended. Return how the cell that ran has ended."""
        self.kill()  # end the programs that the cell has started, too: they hold the kernel's sockets open
        if not self._desk_failed:
            self._ask(Do.DRAIN, wall_time(_DESK_SECONDS), of_living=False)
        if self._desk_failed:
            return Ended.TOO_MUCH_OUTPUT
        return self._guard.reason() or Ended.KERNEL_DIED

    def _ask(
        self, do: Do, left: Left, cell: int = 0, source: str = "", *, of_living: bool = True
    ) -> Said | None:
        """Send an order to the desk, and return the answer; None without an answer (:meth:`_await_answer`)."""
        self._sent += 1
        try:
            self._lines.say_json(msgspec.json.encode(DeskOrder(self._sent, do, cell, source)))
        except Hangup as error:
            self._desk_ended(error)
            return None
        return self._await_answer(left, of_living=of_living)

    def _await_answer(self, left: Left, *, of_living: bool = True) -> Said | None:
        """Wait until the desk has answered the last order, and return the answer.

        Return None if the time is up, a limit is exceeded, the kernel has ended, or the desk has ended. If a limit is
        exceeded or the desk has ended, also kill the kernel.

        Args:
            left: Returns the seconds that are left.
            of_living: False if the kernel has ended already. Then the wait goes on until the desk answers or ends, or
                the time is up.
        """
        waiting = select.poll()
        waiting.register(self._desk_says, select.POLLIN)
        if of_living:
            waiting.register(self._process, select.POLLIN)
        while True:
            # Look at the clock before reading: an answer that came in time counts, even if the grader was slow to read.
            is_over = (of_living and not self.alive) or left() <= 0
            try:
                # Answers to earlier orders may still be on their way, for example after an order that ran out of time.
                while (answer := self._answer()).number < self._sent:
                    pass
                return answer.said
            except Silent:
                pass
            except (Hangup, NotAdmitted) as error:
                self._desk_ended(error)
                return None
            if self._guard.exceeded() and of_living:
                self.kill()
                return None
            if is_over:
                return None
            waiting.poll(1 + int(1000 * max(0.0, min(left(), INTERVAL))))

    def _answer(self) -> DeskAnswer:
        """Return the next answer of the desk.

        Raises:
            Silent: The desk has not answered yet.
            Hangup: The desk has ended, or has sent too much.
            NotAdmitted: The message is not a valid answer.
        """
        line = self._lines.hear_json(0.0)
        orders = range(self._answered + 1, self._sent + 1)
        answer = admitted_answer(line, self._longest, orders, self._cells)
        self._answered = answer.number
        for cell, outputs in answer.outputs.items():
            self._outputs.put(cell, msgspec.to_builtins(outputs))
        return answer

    def _desk_ended(self, error: Exception) -> None:
        """End a kernel whose desk has failed, and record if it was the system that killed the desk."""
        self._desk_failed = True
        has_ended = isinstance(error, Hangup) and not isinstance(error, TooLong)
        if has_ended and self._desk.wait(_DESK_SECONDS):
            # A desk cannot kill itself, so the system has killed it, usually because memory is short.
            self._desk_lost = self._desk.lost or self._desk.status == signal.SIGKILL
        self._desk.end()
        self.kill()

    def _last_words(self) -> str:
        with contextlib.suppress(OSError):
            lines = os.read(self._log, 1 << 16).decode(errors="replace").strip().splitlines()
            if lines:
                return lines[-1][:500]
        return "without a word"


def _listener(path: Path) -> socket.socket:
    """Return a listening Unix socket. The grader makes it; ZeroMQ in the kernel would make it inside the box."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    listener.listen(8)
    return listener


def _log_pipe() -> tuple[int, int]:
    """Return a pipe that refuses further text once it is full. So it need not be read while the kernel runs."""
    reading, writing = os.pipe()
    for end in (reading, writing):
        os.set_blocking(end, False)
    return reading, writing
