"""The grader's own end of a kernel's connections: as ZeroMQ speaks, and with a limit on what is kept of a message."""

from __future__ import annotations

import socket
import threading
import time
import tracemalloc
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import pytest
import zmq

from autograder.boxes.zmtp import ZmtpConnection, _frame

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

GREETING = b"\xff" + bytes(8) + b"\x7f\x03\x01" + b"NULL".ljust(20, b"\0") + bytes(32)
READY = _frame(b"\x05READY\x0bSocket-Type\0\0\0\x03PUB", 4)
SAID = [[b"topic", b"one"], [b"", b"x" * 100_000, b"end"], [b""]]


def heard(connection: ZmtpConnection, until: Callable[[list[list[bytes]]], bool]) -> list[list[bytes]]:
    """What comes, until it is enough or five seconds are over."""
    found: list[list[bytes]] = []
    end = time.monotonic() + 5.0
    while not until(found) and time.monotonic() < end:
        connection.fileno()
        found += connection.received()
        time.sleep(0.001)
    return found


@contextmanager
def peer(path: Path, *says: bytes) -> Iterator[list[bytes]]:
    """Somebody who listens and says these bytes to whoever comes, the first to the first one; what they heard."""
    heard_first: list[bytes] = []
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
        listener.listen()

        def serve() -> None:
            for words in says:
                with suppress(OSError):
                    connection, _ = listener.accept()
                    with connection:
                        heard_first.append(connection.recv(64))
                        connection.sendall(words)
                        time.sleep(0.05)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield heard_first
        thread.join(5.0)


@pytest.mark.parametrize("kind", [zmq.PUB, zmq.XPUB])
def test_what_zeromq_publishes_is_heard(tmp_path: Path, kind: int) -> None:
    with zmq.Context() as context, context.socket(kind) as publisher:
        publisher.bind(f"ipc://{tmp_path / 'p'}")
        connection = ZmtpConnection(tmp_path / "p", "SUB", 1_000_000)

        def publish(found: list[list[bytes]]) -> bool:
            if not found:
                publisher.send(b"are you there?")
            return bool(found)

        assert heard(connection, publish)
        for parts in SAID:
            publisher.send_multipart(parts)
        found = heard(connection, lambda found: [b""] in found)
        assert [parts for parts in found if parts != [b"are you there?"]] == SAID
        connection.close()


def test_zeromq_is_asked_and_answers(tmp_path: Path) -> None:
    with zmq.Context() as context, context.socket(zmq.ROUTER) as router:
        router.bind(f"ipc://{tmp_path / 'r'}")
        connection = ZmtpConnection(tmp_path / "r", "DEALER", 1_000_000)
        for parts in SAID:
            connection.send(parts)
        for parts in SAID:
            assert heard(connection, lambda _: bool(router.poll(10))) == []
            identity, *asked = router.recv_multipart()
            assert asked == parts
            router.send_multipart([identity, *asked])
        assert heard(connection, lambda found: len(found) == len(SAID)) == SAID
        connection.close()


@pytest.mark.parametrize(
    "large",
    [
        _frame(b"x" * 50_000, 1) * 200 + _frame(b"end", 0),
        _frame(b"", 1) * 50_000 + _frame(b"end", 0),
        _frame(b"x" * 2_000_000, 0),
        _frame(b"x" * 9_000, 1) + _frame(b"x" * 2_000, 0),
    ],
    ids=["parts without end", "empty parts without end", "one part", "together"],
)
def test_of_a_message_that_is_too_large_nothing_is_kept(tmp_path: Path, large: bytes) -> None:
    with peer(tmp_path / "p", GREETING + READY + large + _frame(b"small", 0)):
        connection = ZmtpConnection(tmp_path / "p", "SUB", 10_000)
        tracemalloc.start()
        assert heard(connection, bool) == [[b"small"]]
        assert tracemalloc.get_traced_memory()[1] < 2_000_000
        tracemalloc.stop()
    assert (connection.dropped, connection.read > len(large)) == (1, True)
    connection.close()


@pytest.mark.parametrize("garbage", [b"x" * 64, bytes(1000), b"", GREETING[:10] + bytes(54)])
def test_whoever_speaks_something_else_is_left_and_called_again(tmp_path: Path, garbage: bytes) -> None:
    with peer(tmp_path / "p", garbage, GREETING + READY + _frame(b"said", 0)) as greetings:
        connection = ZmtpConnection(tmp_path / "p", "SUB", 10_000)
        assert heard(connection, bool) == [[b"said"]]
    assert [greeting[:10] for greeting in greetings] == [GREETING[:10]] * 2
    connection.close()


def test_a_size_that_no_memory_has_is_only_read_past(tmp_path: Path) -> None:
    endless = b"\x02" + b"\xff" * 8 + b"x" * 1_000_000
    with peer(tmp_path / "p", GREETING + READY + endless):
        connection = ZmtpConnection(tmp_path / "p", "SUB", 10_000)
        assert heard(connection, lambda _: connection.read > 1_000_000) == []
    connection.close()
