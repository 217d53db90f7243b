"""Somebody new asks all participants who they are: on sockets, and with a real one."""

from __future__ import annotations

import socket
import time
from typing import TYPE_CHECKING

import pytest

from course_runtime.ros2_command.ports import ports_in_use
from course_runtime.ros2_command.roll_call import LOOPBACK, RollCall

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from conftest import Running

ANNOUNCER = b"\x00\x01\x00\xc2"


@pytest.fixture
def roll_call() -> Iterator[RollCall]:
    asking = RollCall()
    yield asking
    asking.close()


@pytest.fixture
def plain() -> Iterator[socket.socket]:
    """A socket that stands for a participant's."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind((LOOPBACK, 0))
        one.settimeout(30)
        yield one


def answer(prefix: bytes, words: bytes) -> bytes:
    return b"RTPS\x02\x03\x01\x0f" + prefix + b"\x15\x05" + ANNOUNCER + words


def test_answers_are_noted_and_handed_on(roll_call: RollCall, plain: socket.socket) -> None:
    own = plain.getsockname()[1]
    roll_call.call([own])
    question, asker = plain.recvfrom(4096)
    assert question.startswith(b"RTPS")
    ros, other = answer(b"r" * 12, b"enclave=/;"), answer(b"s" * 12, b"")
    for message in (ros, other, b"RTPS, but no announcement of anybody", b"noise"):
        plain.sendto(message, asker)
    roll_call.listen([own])
    assert (roll_call.answered, roll_call.strangers) == ({b"r" * 12}, {b"s" * 12})
    assert {plain.recv(4096), plain.recv(4096)} == {ros, other}


def test_each_call_is_of_somebody_new_and_is_taken_back(roll_call: RollCall, plain: socket.socket) -> None:
    roll_call.call([plain.getsockname()[1]])
    first, asker = plain.recvfrom(4096)
    roll_call.call([plain.getsockname()[1]])
    disposal, second = plain.recv(4096), plain.recv(4096)
    assert disposal[8:20] == first[8:20] != second[8:20]
    plain.sendto(answer(b"r" * 12, b"enclave=/;"), asker)
    roll_call.listen([])
    assert roll_call.answered == set(), "an answer to the first call is none to the second"


@pytest.mark.ros
def test_a_real_participant_answers_every_call(
    roll_call: RollCall, start: Callable[..., Running], domain: str
) -> None:
    pytest.importorskip("rclpy")
    start("talker", program=True).wait_for("said")
    here = ports_in_use(int(domain))
    assert here
    assert len(here.others) == 1
    who = set()
    for _ in range(3):
        roll_call.call(here.others)
        ends = time.monotonic() + 30
        while not roll_call.answered and time.monotonic() < ends:
            time.sleep(0.01)
            roll_call.listen([])
        (prefix,) = roll_call.answered
        who.add(prefix)
    assert len(who) == 1
