"""The process that executes notebooks: what it says arrives, its end is told, and it is started again or not."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from autograder.grading.running import process_link
from autograder.grading.running.process_link import ProcessLink
from autograder.grading.running.worker_messages import ADDRESS, Answered, Broken, Drop, Give, Joined, Left
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

JOINED = Joined(ADDRESS, ADDRESS, b"offer")
SAY = f"import os, sys, time; say = lambda *_: os.write(0, {msgspec.json.encode(JOINED)!r} + b'\\n')\n"
ANSWER = cases(__file__, "ANSWER")
"""Answers each order with the order."""


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[subprocess.Popen[bytes]]]:
    """The processes that were started, each of which runs the program in ``words``."""
    processes: list[subprocess.Popen[bytes]] = []

    class Child:
        def __init__(self, _: str, program: str, **__: Any) -> None:
            self.program = program

        def start(self, **options: Any) -> subprocess.Popen[bytes]:
            processes.append(subprocess.Popen([sys.executable, "-c", self.program], **options))
            return processes[-1]

    monkeypatch.setattr(process_link, "python_child", Child)
    yield processes
    assert all(process.poll() is not None for process in processes), "each has ended with its link"


def test_each_order_is_answered_while_many_are_on_their_way(
    started: list[subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    orders = {number: bytes([number]) * 300_000 for number in range(20)}
    with ProcessLink(ANSWER, scratch=tmp_path) as link:
        assert link.hear(0.01) is None
        for number, order in orders.items():
            link.say(Give(number, ADDRESS, order))
            link.say(Drop(number))
        answers = [link.hear(10.0) for _ in orders]
        assert {one.number: one.data for one in answers if isinstance(one, Answered)} == orders
        assert link.hear(0.01) is None
    assert len(started) == 1


def test_a_process_that_ends_is_started_again_and_its_orders_are_told_to_be_lost(
    started: list[subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    with ProcessLink(f"{SAY}say(); print('a last word'); sys.exit(1)", scratch=tmp_path) as link:
        for _ in range(process_link._STARTS + 2):
            assert link.hear(30.0) == JOINED
            assert link.hear(30.0) == Left(ADDRESS, "its process ended (a last word)")
    assert len(started) == process_link._STARTS + 3


@pytest.mark.parametrize("program", ["", "import os; os.write(0, b'no message\\n')"])
def test_a_process_that_says_nothing_is_not_started_for_ever(
    started: list[subprocess.Popen[bytes]], tmp_path: Path, program: str
) -> None:
    with ProcessLink(program, scratch=tmp_path) as link:
        said = [link.hear(30.0) for _ in range(process_link._STARTS)]
    assert [type(one) for one in said] == [Left, Left, Broken]
    assert len(started) == process_link._STARTS
    words = "an invalid message" if program else "its process ended"
    assert all(words in one.reason for one in said if isinstance(one, Left | Broken))


def test_a_process_that_only_passes_messages_on_is_not_started_again(
    started: list[subprocess.Popen[bytes]],
) -> None:
    with ProcessLink(f"{SAY}say()", scratch=None) as link:
        assert link.hear(30.0) == JOINED
        assert link.hear(30.0) == Broken("its process ended")
    assert len(started) == 1


def test_the_end_of_the_block_ends_the_process(
    started: list[subprocess.Popen[bytes]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process_link, "_GOODBYE_SECONDS", 60.0)
    with ProcessLink(ANSWER, scratch=tmp_path) as link:
        link.say(Give(1, ADDRESS, b"x"))
        assert link.hear(30.0) == Answered(1, b"x")
    assert [process.returncode for process in started] == [0], "it ends by itself when it is asked to"
