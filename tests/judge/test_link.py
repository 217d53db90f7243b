"""What a notebook may say to the judge."""

from __future__ import annotations

import socket
import threading

import pytest

from autograder.judge import link
from autograder.judge.link import Link, LinkClosed


def _pair() -> tuple[socket.socket, Link]:
    here, there = socket.socketpair()
    return here, Link(there)


def test_messages_come_one_by_one_however_they_are_cut() -> None:
    wire, judge = _pair()
    wire.sendall(b'{"say": "check", "exercise": "lab_1_2.talker"}\n{"say": "re')
    assert judge.receive()["exercise"] == "lab_1_2.talker"
    wire.sendall(b'ady"}\n')
    assert judge.receive() == {"say": "ready"}


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(b"hello\n", id="no JSON"),
        pytest.param(b"[1, 2]\n", id="no object"),
        pytest.param(b'{"exercise": "lab_1_2.talker"}\n', id="no word"),
        pytest.param(b'{"say": 7}\n', id="a number for a word"),
        pytest.param(b"\xff\xfe\n", id="no text"),
        pytest.param(b"[" * 100_000 + b"\n", id="too deep"),
        pytest.param(b"", id="nothing"),
    ],
)
def test_what_is_no_message_ends_the_conversation(line: bytes) -> None:
    wire, judge = _pair()
    wire.sendall(line)
    wire.close()
    with pytest.raises(LinkClosed):
        judge.receive()


def test_an_endless_line_ends_the_conversation() -> None:
    wire, judge = _pair()
    flood = threading.Thread(target=_flood, args=(wire,), daemon=True)
    flood.start()
    with pytest.raises(LinkClosed, match="too long"):
        judge.receive()
    judge.close()
    flood.join()


def _flood(wire: socket.socket) -> None:
    try:
        for _ in range(10):
            wire.sendall(b"x" * link.MAX_LINE)
    except OSError:
        pass


def test_talking_to_nobody_is_noticed() -> None:
    wire, judge = _pair()
    wire.close()
    with pytest.raises(LinkClosed):
        _talk_on(judge)


def _talk_on(judge: Link) -> None:
    # The first message may still go into the kernel's buffer.
    for _ in range(100):
        judge.send("release", run=1)
