"""A kernel's desk: a process in a box that reads the messages of one student's kernel, and nothing else.

A desk is a fork of the kernels' fork server, which has loaded Jupyter's protocol (``jupyter_client.session``) and
ZeroMQ. It connects to the kernel. Then, before it reads anything, it gives itself a filter of system calls. From then
on it cannot open files, start processes or threads, or make further connections. ZeroMQ keeps a message of any size in
memory until its last part has come, so the process has a memory limit. :mod:`autograder.execution.jupyter_kernel` gives
the orders.
"""

from __future__ import annotations

import contextlib
import socket
import sys
import time
from typing import TYPE_CHECKING, Any

import msgspec
import zmq
from jupyter_client.session import Session
from zmq.utils.monitor import recv_monitor_message

from autograder.boxes.process_isolation import filter_system_calls
from autograder.boxes.run_limits import Limits
from autograder.boxes.seccomp_filter import filter_for_desks
from autograder.execution.executed_cells import Budget, OutputCollector
from autograder.execution.kernel_channels import IOPUB, SHELL
from autograder.execution.kernel_desk_messages import DeskAnswer, DeskOrder, Do, Said
from autograder.messages.json_lines import Hangup, Lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

_ASK_AGAIN_S = 0.5
_LAST_OUTPUT_S, _LONGEST_LAST_OUTPUT_S = 5.0, 20.0
"""Time limits in seconds for a cell's last outputs: the longest pause between two messages, and the longest time in
all.
"""
_AT_ONCE = 100
"""The maximum number of messages that are read from one connection before the others have their turn."""
_WAITING = 500
"""The maximum number of messages that ZeroMQ keeps for the desk. Further ones wait in the kernel, which drops some of
them.
"""
_TOO_LARGE = "\n[output that was too large was dropped]\n"


def prepare() -> None:
    """Load everything that a desk needs, because a desk itself cannot open files."""
    session = Session(key=b"rehearsal", check_pid=False)
    asked = session.msg("execute_request", {"code": ""})
    sent = session.serialize(session.msg("stream", {"name": "stdout", "text": "x"}, parent=asked))
    session.deserialize(session.feed_identities(sent)[1])
    msgspec.json.decode(msgspec.json.encode(DeskOrder(1, Do.DRAIN)), type=DeskOrder)
    msgspec.json.encode(DeskAnswer(0, Said.DONE, {}))


def serve(descriptors: Sequence[int], address: str, key: str, limits: Mapping[str, Any]) -> None:
    """Carry out the grader's orders until the grader closes the connection.

    Args:
        descriptors: The socket for the orders.
        address: The first part of the paths of the kernel's sockets; a number follows.
        key: The key that signs the messages.
        limits: The fields of the notebook's :class:`Limits`.
    """
    with contextlib.suppress(Hangup):
        desk = _Desk(address, key, Limits(**limits), socket.socket(fileno=descriptors[0]))
        filter_system_calls(filter_for_desks(), every_thread=True)
        desk.serve()


class _Desk:
    def __init__(self, address: str, key: str, limits: Limits, orders: socket.socket) -> None:
        self._limits = limits
        # To send a longer message without a copy, ZeroMQ would start a thread, which the desk's filter refuses.
        self._session = Session(key=key.encode(), check_pid=False, copy_threshold=sys.maxsize)
        self._poller = zmq.Poller()
        context = zmq.Context()
        self._shell, _ = _connected(context, zmq.DEALER, f"ipc://{address}-{SHELL}")
        self._iopub, self._kernel_ends = _connected(context, zmq.SUB, f"ipc://{address}-{IOPUB}")
        self._orders, self._order_socket = Lines(orders), orders
        _await_threads(context)
        for source in (self._shell, self._iopub, orders):
            self._poller.register(source, zmq.POLLIN)
        self._budget = Budget(limits.notebook_output_bytes)
        self._collectors: dict[int, OutputCollector] = {}
        self._cells: dict[str, int] = {}
        self._changed: set[int] = set()
        self._current = ""
        self._probes: set[str] = set()
        self._read = 0
        self._reply: Mapping[str, Any] | None = None
        self._idle = self._probed = self._heard = False

    def serve(self) -> None:
        """Tell the grader that the kernel is ready, then carry out the grader's orders."""
        while not (self._probed and self._heard):
            # Send this repeatedly, because the kernel drops outputs until the desk's subscription has reached it.
            self._ask_for_a_sign()
            self._wait(lambda: self._probed and self._heard, _ASK_AGAIN_S)
        self._answer(0, Said.DONE)
        while True:
            order = msgspec.json.decode(self._orders.hear_json(), type=DeskOrder)
            match order.do:
                case Do.EXECUTE:
                    said = self._execute(order)
                case Do.SETTLE:
                    said = self._settle()
                case Do.DRAIN:
                    said = self._drain()
            self._answer(order.number, said)

    def _execute(self, order: DeskOrder) -> Said:
        self._collectors[order.cell] = OutputCollector(self._limits.cell_output_bytes, self._budget)
        self._reply, self._idle, self._read = None, False, 0
        content = {
            "code": order.source,
            "silent": False,
            "store_history": True,
            "user_expressions": {},
            "allow_stdin": False,
            "stop_on_error": False,
        }
        self._current = self._send("execute_request", content)
        self._cells[self._current] = order.cell
        most = self._limits.flood_bytes
        if not self._wait(lambda: self._reply is not None or self._read > most):
            return Said.OPEN
        if self._reply is None:
            return Said.FLOODS
        return self._ended(self._reply)

    def _ended(self, reply: Mapping[str, Any]) -> Said:
        """Wait for a cell's last outputs, which may arrive after the kernel's answer. Return how the cell ended."""
        until = time.monotonic() + _LONGEST_LAST_OUTPUT_S
        self._wait(lambda: self._idle or time.monotonic() > until, _LAST_OUTPUT_S)
        if _asks_to_exit(reply):
            return Said.EXITS
        return Said.DONE if reply.get("status") == "ok" else Said.RAISED

    def _settle(self) -> Said:
        # An interrupt can hit the kernel's own code, such as its flush of printed text; then the cell's answer is lost.
        # A request that is sent after the interrupt is still answered.
        self._probes.clear()
        self._probed = False
        self._ask_for_a_sign()
        is_settled = self._wait(lambda: self._probed or (self._reply is not None and self._idle))
        return Said.DONE if is_settled else Said.OPEN

    def _drain(self) -> Said:
        self._poller.register(self._kernel_ends, zmq.POLLIN)
        self._wait(lambda: bool(self._kernel_ends.poll(0)))
        while any(True for _ in self._arrived()):
            pass
        return Said.DONE

    def _wait(self, is_enough: Callable[[], bool], silence: float | None = None) -> bool:
        """Read messages until ``is_enough`` holds. Return False at a new order, or after ``silence`` idle seconds."""
        while not is_enough():
            ready = dict(self._poller.poll(None if silence is None else int(1000 * silence)))
            if not ready or self._order_socket.fileno() in ready:
                return False
            for _ in self._arrived():
                if is_enough():
                    break
        return True

    def _arrived(self) -> Iterator[None]:
        """Process the messages that have arrived, and yield after each. Outputs come first, as they are sent first."""
        for source in (self._iopub, self._shell):
            for _ in range(_AT_ONCE):
                try:
                    frames = source.recv_multipart(zmq.NOBLOCK, copy=False)
                except zmq.Again:
                    break
                with contextlib.suppress(Exception):  # a message with a wrong format or a forged signature
                    self._take(source, frames)
                yield

    def _take(self, source: zmq.Socket[bytes], frames: list[Any]) -> None:
        size = sum(map(len, frames))
        parts: list[Any] = self._session.feed_identities(frames, copy=False)[1]
        if source is self._iopub and size > self._limits.message_bytes:
            request = self._session.unpack(bytes(parts[2])).get("msg_id")
            # A message of an earlier cell does not count for the current one.
            self._read += size if request == self._current else 0
            self._keep(request, "stream", {"name": "stdout", "text": _TOO_LARGE})
            return
        self._read += size
        message = self._session.deserialize(parts, copy=False)
        request, content = message["parent_header"].get("msg_id"), message["content"]
        if source is self._iopub:
            self._heard |= request in self._probes
            self._idle |= request == self._current and content.get("execution_state") == "idle"
            self._keep(request, message["msg_type"], content)
        elif request in self._probes:
            self._probed = True
        elif request == self._current and message["msg_type"] == "execute_reply":
            self._reply = content

    def _keep(self, request: str, message_type: str, content: Mapping[str, Any]) -> None:
        """Add an output to the cell that requested it, even if that cell ended long ago."""
        cell = self._cells.get(request)
        if cell is not None and message_type != "status":
            self._collectors[cell].handle(message_type, content)
            self._changed.add(cell)

    def _send(self, message_type: str, content: dict[str, Any]) -> str:
        message = self._session.msg(message_type, content)
        self._session.send(self._shell, message)
        return str(message["header"]["msg_id"])

    def _ask_for_a_sign(self) -> None:
        self._probes.add(self._send("kernel_info_request", {}))

    def _answer(self, number: int, said: Said) -> None:
        outputs = {cell: self._collectors[cell].outputs() for cell in self._changed}
        self._changed.clear()
        document = {"number": number, "said": said, "outputs": outputs}
        self._orders.say_json(msgspec.json.encode(document))


def _connected(
    context: zmq.Context[Any], kind: int, address: str
) -> tuple[zmq.Socket[bytes], zmq.Socket[bytes]]:
    """Return a socket that is connected to the kernel, and one that becomes readable when that connection ends."""
    client: zmq.Socket[bytes] = context.socket(kind)
    client.setsockopt(zmq.RECONNECT_IVL, -1)
    client.setsockopt(zmq.RCVHWM, _WAITING)
    client.setsockopt(zmq.LINGER, 0)
    if kind == zmq.SUB:
        client.setsockopt(zmq.SUBSCRIBE, b"")
    connected = client.get_monitor_socket(zmq.EVENT_CONNECTED | zmq.EVENT_DISCONNECTED)
    client.connect(address)
    recv_monitor_message(connected)
    return client, connected


def _await_threads(context: zmq.Context[Any]) -> None:
    """Wait until both of ZeroMQ's threads run, because the desk's filter refuses system calls with which they begin.

    One thread has made the connections. The other closes sockets, and reports that to a monitor.
    """
    closed, monitor = context.socket(zmq.PAIR), context.socket(zmq.PAIR)
    closed.monitor("inproc://closed", zmq.EVENT_MONITOR_STOPPED)
    monitor.connect("inproc://closed")
    closed.close()
    monitor.recv_multipart()
    monitor.close()


def _asks_to_exit(reply: Mapping[str, Any]) -> bool:
    """Return True if the kernel's answer says that the cell called ``exit()`` or ``quit()``."""
    payload = reply.get("payload")
    return isinstance(payload, list) and any(
        isinstance(part, dict) and part.get("source") == "ask_exit" for part in payload
    )
