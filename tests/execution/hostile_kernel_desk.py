"""Programs in the place of a kernel's desk: what code that has taken over the desk could do.

A cell of the notebook names the function that its desk runs. A notebook that names none is read as usual, so that a
test sees the results of the other students.
"""

from __future__ import annotations

import ctypes
import os
import random
import signal
import time
from typing import TYPE_CHECKING, Any

import msgspec
import re2

from autograder.execution import kernel_desk, kernel_process
from tests.boxes.reach import reached

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.execution.kernel_desk_messages import DeskOrder, Said

_NAMED = re2.compile(r"hostile: (\w+) ?(\d*)")
SCRIPT = "<script>fired()</script><img src=x onerror=fired()>"
_SCRIPT = SCRIPT.encode()
_HONEST = b'{"number": 1, "said": "done", "outputs": {}}'

CRAFTED: tuple[bytes, ...] = (
    *(b"", b"null", b"[]", b"{}", b"\xff", b"[" * 900_000, b'{"number": 1}'),
    b'{"number": 1, "said": "passed", "outputs": {}}',
    b'{"number": 2, "said": "done", "outputs": {}}',
    b'{"number": -1, "said": "done", "outputs": {}}',
    b'{"number": 1e999, "said": "done", "outputs": {}}',
    b'{"number": 1, "said": "done", "outputs": {}, "verdicts": {"0": {"score": 10}}}',
    *(b'{"number": 1, "said": "done", "outputs": {%s}}' % outputs for outputs in (
        b'"1": []', b'"-1": []', b'"99": []', b'"x": []', b'"0": null', b'"0": {}', b'"0": [1]', b'"0": [{}]',
        b'"0": [{"output_type": "html", "text": ""}]',
        b'"0": [{"output_type": "stream", "name": "stdin", "text": ""}]',
        b'"0": [{"output_type": "stream", "name": "stdout", "text": ["x"]}]',
        b'"0": [{"output_type": "stream", "name": "stdout", "text": "\\ud800"}]',
        b'"0": [{"output_type": "display_data", "data": {"text/html": "%s"}, "metadata": {}}]' % _SCRIPT,
        b'"0": [{"output_type": "display_data", "data": {}, "metadata": {"image/png": "x"}}]',
        b'"0": [{"output_type": "error", "ename": "", "evalue": "", "traceback": [%s]}]'
        % b", ".join([b'""'] * 201),
    )),
)  # fmt: skip
"""Documents that no kernel brings about."""


def prepare(*words: str) -> None:
    """Be as ready as the fork server of kernels and desks."""
    kernel_process.prepare(*words)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Be a kernel, or do as a desk what the notebook names."""
    kernel_desk._Desk = _HostileDesk  # type: ignore[misc]
    kernel_process.run(call, descriptors)


class _HostileDesk(kernel_desk._Desk):
    def _execute(self, order: DeskOrder) -> Said:
        said = super()._execute(order)
        named = _NAMED.search(order.source)
        if named is not None:
            globals()[named[1]](self, int(named[2] or 0))
        return said

    def tell(self, data: bytes) -> None:
        self._orders.say_json(data)

    def send(self, data: bytes) -> None:
        self._order_socket.sendall(data)

    def tell_text(self, text: str) -> None:
        self._keep(self._current, "stream", {"name": "stdout", "text": text})


def crafted(desk: _HostileDesk, number: int) -> None:
    desk.tell(CRAFTED[number])


def at_random(desk: _HostileDesk, number: int) -> None:
    desk.send(random.Random(number).randbytes(10_000) + b"\n")


def endless(desk: _HostileDesk, number: int) -> None:
    while True:
        pass


def endless_answer(desk: _HostileDesk, number: int) -> None:
    while True:
        desk.send(bytes(1 << 20))


def late(desk: _HostileDesk, number: int) -> None:
    """Answer after the time of the cell."""
    time.sleep(5.0)


def twice(desk: _HostileDesk, number: int) -> None:
    desk.tell(_HONEST)


def memory(desk: _HostileDesk, number: int) -> None:
    hoard = []
    while True:
        hoard.append(bytearray(10_000_000))


def crash(desk: _HostileDesk, number: int) -> None:
    ctypes.string_at(0)


def leave(desk: _HostileDesk, number: int) -> None:
    os._exit(0)


def script(desk: _HostileDesk, number: int) -> None:
    """Script in every text that an answer may have."""
    data = {"text/plain": SCRIPT, "image/png": SCRIPT}
    outputs = [
        {"output_type": "stream", "name": "stderr", "text": SCRIPT},
        {"output_type": "display_data", "data": data, "metadata": {}},
        {"output_type": "error", "ename": SCRIPT, "evalue": SCRIPT, "traceback": [SCRIPT]},
    ]
    desk.tell(msgspec.json.encode({"number": 1, "said": "raised", "outputs": {0: outputs}}))


def too_many_outputs(desk: _HostileDesk, number: int) -> None:
    outputs = [{"output_type": "stream", "name": name, "text": "x"} for name in ("stdout", "stderr")] * 15_000
    desk.tell(msgspec.json.encode({"number": 1, "said": "done", "outputs": {0: outputs}}))


def reach(desk: _HostileDesk, number: int) -> None:
    """Say what a desk can reach."""
    delay = {"its end's delay": lambda: signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGXCPU])}
    desk.tell_text(f"reached: {reached(delay)}.")
