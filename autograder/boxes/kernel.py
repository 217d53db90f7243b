"""A Jupyter kernel in a process of its own, spoken to over Unix sockets with nothing but polling and deadlines.

nbclient is made for notebooks one trusts: it keeps all output, believes each message's form and learns of a
dead kernel from a heartbeat. Here every wait ends at a message, at the process's end or at a deadline,
whichever is first, and what arrives is only looked at as far as it has the right form (Jupyter messaging
specification 5.4).
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
"""Called with the id of the request, the message type and the content of each output."""

_ASK_AGAIN_S = 0.5
_LAST_OUTPUT_S = 2.0
"""Seconds without anything new, after which a cell's last outputs are no longer waited for."""
SHELL, IOPUB = 1, 2
"""The channels that are used, as they are numbered in the sockets' names."""
_TOO_LARGE = "\n[output that was too large was dropped]\n"


class KernelFailed(RuntimeError):
    """The kernel did not start or did not answer; the message says why."""


@dataclass(frozen=True)
class Channels:
    """The channels that a kernel is started with.

    Attributes:
        address: The path in the names of its sockets.
        key: What its messages are signed with.
        shell: The listening socket for requests.
        iopub: The listening socket for outputs.
        log: Where it writes what is no output of a cell; full after one pipe.
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
        folder: For the sockets; a short path, since Unix socket names have at most 107 characters. No box sees it.
        start: Starts the process.
        limits: Of these ``start_seconds``, ``interrupt_grace``, ``message_bytes`` and ``flood_bytes``.
        on_output: Gets every output; never called after :meth:`close`.
        guard: Says when the box has exceeded another limit.

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
        """True if the grader itself lost it: then its end says nothing about the notebook."""
        return self._process.lost

    def await_ready(self) -> None:
        """Wait until the kernel answers and its outputs reach us.

        Raises:
            KernelFailed: It ended or did not answer within ``start_seconds``.
        """
        if not self._shake_hands(time.monotonic() + self._limits.start_seconds):
            if self.alive:
                raise KernelFailed(f"the kernel did not answer within {self._limits.start_seconds:g} s")
            raise KernelFailed(f"the kernel ended while it started: {self._last_words()}")

    def execute(self, source: str, left: Left, request: Callable[[str], None] = lambda _: None) -> Ended:
        """Execute one cell.

        A cell that is still running when its time is up is interrupted; a kernel that does not obey is killed.

        Args:
            source: The cell's text.
            left: The seconds that it has left, whenever it is asked.
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
        # An interrupt that meets the kernel's own code, such as its flush of what was printed, takes the answer away.
        # What is asked behind it is answered all the same.
        next_one = self._ask("kernel_info_request", {})
        grace = wall_time(self._limits.interrupt_grace)
        if self._await_reply(asked, grace, next_one) is None:
            self.kill()
        return stopped_for

    def kill(self) -> None:
        """End the process and all that it started."""
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
        """The end of the cell, or None where it is still running when its time is up.

        Args:
            request: The id of the request that executes it.
            left: The seconds that it has left.
            next_one: The id of a request behind it, whose answer says as well that it has ended.
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
            # It was over before the watch came by: it ends as it would have ended a moment later.
            self.kill()
            return self._died()
        return Ended.DONE if reply.get("status") == "ok" else Ended.RAISED

    def _await_idle(self, request: str, left: Left) -> None:
        """The reply is there; the last outputs travel on the other socket and may be a little later.

        On a crowded machine much later: an earlier cell's line of 100 MB may be in front of them.
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
        """Ask until both an answer and its echo among the outputs have arrived; whether they have."""
        answered = heard = False
        asked: set[str] = set()
        while self.alive and time.monotonic() < deadline:
            # Asked more than once because outputs published before our subscription was known are lost.
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
        """Count what is read from now on, without the rest of what was too large: that is an earlier cell's."""
        self._read_before = self._iopub.read + self._shell.read + self._iopub.owed

    def _died(self) -> Ended:
        """The reason why the kernel is gone."""
        return self._guard.reason() or Ended.KERNEL_DIED

    def _messages(self, left: Left) -> Iterator[tuple[ZmtpConnection, dict[str, Any]]]:
        """All messages until the time is up, a limit or the kernel's end; outputs are handed on from here."""
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
        """The connections on which something has come within so many milliseconds; none at the process's end."""
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
            with contextlib.suppress(Exception):  # a message of no or of a forged form
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
    """A Unix socket that listens; ZeroMQ's own would be made in the box."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    listener.listen(8)
    return listener


def _log_pipe() -> tuple[int, int]:
    """A pipe that keeps what is written first and refuses the rest, so that nobody has to read it meanwhile."""
    reading, writing = os.pipe()
    for end in (reading, writing):
        os.set_blocking(end, False)
    return reading, writing


def _parent(message: Mapping[str, Any]) -> str:
    header = message.get("parent_header")
    return str(header.get("msg_id", "")) if isinstance(header, Mapping) else ""


def _answer(message: Mapping[str, Any], request: str) -> Mapping[str, Any]:
    """The content of a message that answers ``request``; empty for any other."""
    content = message.get("content")
    return content if _parent(message) == request and isinstance(content, Mapping) else {}


def _asks_to_exit(reply: Mapping[str, Any]) -> bool:
    """True if ``exit()`` or ``quit()`` was called: the kernel answers first and ends a moment later."""
    payload = reply.get("payload")
    return isinstance(payload, list) and any(
        isinstance(p, Mapping) and p.get("source") == "ask_exit" for p in payload
    )
