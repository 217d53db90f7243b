"""A Jupyter kernel in a process of its own, reached over Unix sockets with polling and deadlines.

nbclient is made for trusted notebooks: it keeps all output, trusts the format of each message and learns of a dead
kernel from a heartbeat. Here every wait ends at a message, at the end of the process or at a deadline, whichever
comes first, and a message is read only as far as it has the right format (Jupyter messaging specification 5.4).
"""

from __future__ import annotations

import contextlib
import os
import secrets
import select
import socket
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.boxes.box import NoSandbox
from autograder.boxes.execution import Ended
from autograder.boxes.guards import INTERVAL, NoGuard
from autograder.boxes.jupyter_messages import SignedMessages
from autograder.boxes.limits import Left, first_of, until, wall_time
from autograder.boxes.zmtp import ZmtpConnection

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.boxes.boxed_processes import ForkedProcess
    from autograder.boxes.guards import Guard
    from autograder.boxes.limits import Limits

Output = Callable[[str, str, Mapping[str, Any]], None]
"""Called for each output with the request's id, the message type and the content."""

_ASK_AGAIN_S = 0.5
_LAST_OUTPUT_S = 2.0
"""Seconds of silence after which a cell's last outputs are no longer expected."""
SHELL, IOPUB = 1, 2
"""The channels in use, by their numbers in the names of the sockets."""
_TOO_LARGE = "\n[output that was too large was dropped]\n"


class KernelFailed(RuntimeError):
    """The kernel did not start or did not answer; the message gives the reason."""


@dataclass(frozen=True)
class Channels:
    """The channels with which a kernel starts.

    Attributes:
        address: The path in the names of the sockets.
        key: The key that signs the messages.
        shell: The listening socket for requests.
        iopub: The listening socket for outputs.
        log: A pipe for what the kernel prints outside any cell; further text is dropped once the pipe is full.
    """

    address: str
    key: str
    shell: int
    iopub: int
    log: int


Start = Callable[[Channels], "ForkedProcess"]


class Kernel:
    """A running kernel.

    Args:
        folder: The folder for the sockets. Its path must be short, as Unix socket names have at most 107 characters.
            No box sees it.
        start: Starts the kernel's process.
        limits: ``start_seconds``, ``interrupt_grace``, ``message_bytes`` and ``flood_bytes`` are used.
        on_output: Gets every output; it is never called after :meth:`close`.
        guard: Reports that the box has exceeded another limit.

    Raises:
        KernelFailed: The process could not be started.
    """

    def __init__(
        self, folder: Path, start: Start, limits: Limits, on_output: Output, guard: Guard | None = None
    ) -> None:
        self._limits = limits
        self._guard = guard or NoGuard()
        self._read_before = self._dropped_before = 0
        self._on_output = on_output
        key = secrets.token_hex(32)
        self._form = SignedMessages(key)
        self._log, log = _log_pipe()
        shell, iopub = (_listener(folder / f"k-{number}") for number in (SHELL, IOPUB))
        try:
            self._process = start(Channels(str(folder / "k"), key, shell.fileno(), iopub.fileno(), log))
        except (OSError, NoSandbox) as error:
            os.close(self._log)
            raise KernelFailed(f"the kernel could not be started: {error}") from error
        finally:
            for listener in (shell, iopub):
                listener.close()
            os.close(log)
        self._shell = ZmtpConnection(folder / f"k-{SHELL}", "DEALER", limits.message_bytes)
        self._iopub = ZmtpConnection(folder / f"k-{IOPUB}", "SUB", limits.message_bytes)
        self._closed = False

    @property
    def alive(self) -> bool:
        """True if the process still runs."""
        return self._process.alive

    @property
    def lost(self) -> bool:
        """True if the grader itself lost the process: then its exit tells nothing about the notebook."""
        return self._process.lost

    def await_ready(self) -> None:
        """Wait until the kernel answers and its outputs reach us.

        Raises:
            KernelFailed: The kernel ended, or did not answer within ``start_seconds``.
        """
        if not self._shake_hands(time.monotonic() + self._limits.start_seconds):
            if self.alive:
                raise KernelFailed(f"the kernel did not answer within {self._limits.start_seconds:g} s")
            raise KernelFailed(f"the kernel ended while it started: {self._last_words()}")

    def execute(self, source: str, left: Left, request: Callable[[str], None] = lambda _: None) -> Ended:
        """Execute one cell.

        A cell that is still running at its limit is interrupted; a kernel that does not react is killed.

        Args:
            source: The cell's text.
            left: Returns the seconds that the cell has left.
            request: Called with the id of this request before any output of it arrives.
        """
        if not self.alive:
            return self._died()
        self._count_anew()
        self._dropped_before = self._iopub.dropped
        content = {
            "code": source,
            "silent": False,
            "store_history": True,
            "user_expressions": {},
            "allow_stdin": False,
            "stop_on_error": False,
        }
        asked, parts = self._form.written("execute_request", content)
        request(asked)
        self._shell.send(parts)
        ended = self._await_reply(asked, left)
        if ended is not None:
            return ended
        stopped_for = Ended.TOO_MUCH_OUTPUT if self._floods else self._guard.reason() or Ended.TIMED_OUT
        self._count_anew()
        self._process.interrupt()  # as JupyterLab's stop button does
        # An interrupt can hit the kernel's own code, such as its flush of printed text; then the cell's answer is
        # lost. A request that is sent after it is still answered.
        next_one = self._ask("kernel_info_request", {})
        grace = wall_time(self._limits.interrupt_grace)
        if self._await_reply(asked, grace, next_one) is None:
            self.kill()
        return stopped_for

    def kill(self) -> None:
        """End the process and everything that it started."""
        self._process.end()

    def close(self) -> None:
        """Kill the kernel and close the sockets; may be called twice."""
        if self._closed:
            return
        self._closed = True
        self.kill()
        os.close(self._log)
        self._shell.close()
        self._iopub.close()

    def _await_reply(self, request: str, left: Left, next_one: str = "") -> Ended | None:
        """Wait for the end of a cell. Return how it ended, or None if it is still running when its time is up.

        Args:
            request: The id of the request that executes the cell.
            left: Returns the seconds that the cell has left.
            next_one: The id of a later request; an answer to it also shows that the cell has ended.
        """
        reply: Mapping[str, Any] | None = None
        idle = False
        for channel, message in self._messages(left):
            content = _answer(message, request)
            idle = idle or (channel is self._iopub and content.get("execution_state") == "idle")
            if channel is self._shell and content and message.get("msg_type") == "execute_reply":
                reply = content
            if channel is self._shell and next_one and _parent(message) == next_one:
                return Ended.TIMED_OUT
            if reply is not None:
                break
        if reply is None:
            return None if self.alive else self._died()
        if not idle:
            self._await_idle(request, left)
        if self._iopub.dropped > self._dropped_before:
            self._on_output(request, "stream", {"name": "stdout", "text": _TOO_LARGE})
        if _asks_to_exit(reply):
            self._process.wait(self._limits.interrupt_grace)
            self.kill()
            return self._died()
        if self._guard.exceeded(at_once=True):
            # The cell ended before the watch saw the excess: treat it as the watch would have done a moment later.
            self.kill()
            return self._died()
        return Ended.DONE if reply.get("status") == "ok" else Ended.RAISED

    def _await_idle(self, request: str, left: Left) -> None:
        """Wait for a cell's last outputs, which use a different socket and may arrive after it.

        If the machine is busy, they may be much later: an earlier cell's line of 100 MB may be in front of them.
        """
        last_read, silence = -1, wall_time(_LAST_OUTPUT_S)

        def before_silence() -> float:
            nonlocal last_read, silence
            if self._iopub.read > last_read:
                last_read, silence = self._iopub.read, wall_time(_LAST_OUTPUT_S)
            return silence()

        longest = wall_time(max(left(), _LAST_OUTPUT_S))
        for channel, message in self._messages(first_of(before_silence, longest)):
            if channel is self._iopub and _answer(message, request).get("execution_state") == "idle":
                return

    def _shake_hands(self, deadline: float) -> bool:
        """Send requests until both an answer and its echo among the outputs have arrived. Return True if they have."""
        answered = heard = False
        asked: set[str] = set()
        while self.alive and time.monotonic() < deadline:
            # Sent repeatedly, because outputs are lost that were published before our subscription reached the
            # kernel.
            asked.add(self._ask("kernel_info_request", {}))
            for channel, message in self._messages(until(min(deadline, time.monotonic() + _ASK_AGAIN_S))):
                if _parent(message) in asked:
                    answered |= channel is self._shell
                    heard |= channel is self._iopub
                if answered and heard:
                    return True
        return False

    @property
    def _floods(self) -> bool:
        return self._iopub.read + self._shell.read - self._read_before > self._limits.flood_bytes

    def _count_anew(self) -> None:
        """Count the bytes read from now on. The rest of an earlier cell's too large message does not count."""
        self._read_before = self._iopub.read + self._shell.read + self._iopub.owed

    def _died(self) -> Ended:
        """Return how the kernel's end counts for the cell."""
        return self._guard.reason() or Ended.KERNEL_DIED

    def _messages(self, left: Left) -> Iterator[tuple[ZmtpConnection, dict[str, Any]]]:
        """Yield messages until the time is up, a limit is exceeded or the kernel ends; outputs are passed on here."""
        while True:
            ready = self._ready(_wait_ms(left))
            if self._guard.exceeded():
                self.kill()
                return
            # Outputs first: they were sent before the reply that ends the cell.
            for channel in (self._iopub, self._shell):
                if channel in ready:
                    for message in self._received(channel):
                        if channel is self._iopub:
                            self._hand_on(message)
                        yield channel, message
            if ready:
                if left() > 0 and not self._floods:
                    continue
                return
            if not self.alive or left() <= 0 or self._floods:
                return

    def _ready(self, wait_ms: int) -> list[ZmtpConnection]:
        """Return the connections with new data within ``wait_ms`` milliseconds; none once the process has ended."""
        channels = (self._iopub, self._shell)
        poll = select.poll()
        poll.register(self._process.fileno(), select.POLLIN)
        for channel in channels:
            if (descriptor := channel.fileno()) >= 0:
                poll.register(descriptor, select.POLLIN | (select.POLLOUT if channel.wants_to_write else 0))
        come = dict(poll.poll(0 if any(channel.is_waiting for channel in channels) else wait_ms))
        return [channel for channel in channels if channel.is_waiting or channel.fileno() in come]

    def _received(self, channel: ZmtpConnection) -> Iterator[dict[str, Any]]:
        for parts in channel.received():
            with contextlib.suppress(Exception):  # a message with a wrong format or a forged signature
                yield self._form.read(parts)

    def _hand_on(self, message: Mapping[str, Any]) -> None:
        content = message.get("content")
        if isinstance(content, Mapping):
            self._on_output(_parent(message), str(message.get("msg_type")), content)

    def _ask(self, message_type: str, content: dict[str, Any]) -> str:
        asked, parts = self._form.written(message_type, content)
        self._shell.send(parts)
        return asked

    def _last_words(self) -> str:
        with contextlib.suppress(OSError):
            lines = os.read(self._log, 1 << 16).decode(errors="replace").strip().splitlines()
            if lines:
                return lines[-1][:500]
        return "without a word"


def _wait_ms(left: Left) -> int:
    return int(1000 * max(0.0, min(left(), INTERVAL))) + 1


def _listener(path: Path) -> socket.socket:
    """A listening Unix socket; ZeroMQ would make its own inside the box."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    listener.listen(8)
    return listener


def _log_pipe() -> tuple[int, int]:
    """A pipe that keeps the first text and refuses more once it is full, so it need not be read meanwhile."""
    reading, writing = os.pipe()
    for end in (reading, writing):
        os.set_blocking(end, False)
    return reading, writing


def _parent(message: Mapping[str, Any]) -> str:
    header = message.get("parent_header")
    return str(header.get("msg_id", "")) if isinstance(header, Mapping) else ""


def _answer(message: Mapping[str, Any], request: str) -> Mapping[str, Any]:
    """The content of a message if it answers ``request``, else empty."""
    content = message.get("content")
    return content if _parent(message) == request and isinstance(content, Mapping) else {}


def _asks_to_exit(reply: Mapping[str, Any]) -> bool:
    """True if the cell called ``exit()`` or ``quit()``: the kernel answers first and ends a moment later."""
    payload = reply.get("payload")
    return isinstance(payload, list) and any(
        isinstance(p, Mapping) and p.get("source") == "ask_exit" for p in payload
    )
