"""A judge in a child process: whatever happens to it, the parent can say so."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.judge import check_process
from autograder.judge.check_process import Child, Undecided, limited

if TYPE_CHECKING:
    import pytest


def _raises() -> bytes:
    raise RuntimeError("broken")


def _dies() -> bytes:
    os.kill(os.getpid(), signal.SIGKILL)
    return b""


def _hangs() -> bytes:
    time.sleep(600)
    return b""


def test_its_bytes_arrive_also_when_they_are_many() -> None:
    assert Child(lambda: b"x" * 3_000_000, limit=60.0).result().data == b"x" * 3_000_000


def test_an_exception_is_no_verdict() -> None:
    outcome = Child(_raises, limit=60.0).result()
    assert outcome.data is None
    assert "code 1" in outcome.trouble


def test_a_killed_child_is_no_verdict() -> None:
    outcome = Child(_dies, limit=60.0).result()
    assert outcome.data is None
    assert "signal 9" in outcome.trouble


def test_a_hanging_child_is_killed_at_its_limit() -> None:
    child = Child(_hangs, limit=0.0)
    outcome = child.result()
    assert outcome.data is None
    assert "in time" in outcome.trouble
    assert not Path(f"/proc/{child.pid}").exists()


def test_a_child_that_is_done_is_noticed_without_waiting() -> None:
    child = Child(_hangs, limit=60.0)
    assert not child.done()
    child.kill()
    assert not Path(f"/proc/{child.pid}").exists()


def test_a_child_that_is_ended_before_its_time_is_told_from_one_that_had_it() -> None:
    def sleep() -> bytes:
        time.sleep(60.0)
        return b""

    assert Child(sleep, limit=30.0).result(within=0.05).hurried
    slow = Child(sleep, limit=0.05).result(within=30.0)
    assert slow.unfinished
    assert not slow.hurried


def test_a_judge_that_is_deciding_at_its_limit_says_so_and_one_that_is_looking_is_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard, tells = os.pipe()

    def ponders() -> bytes:
        try:
            with limited(600.0):
                os.write(tells, b"!")
                while True:
                    pass
        except Undecided:
            return b"undecided"

    with monkeypatch.context() as patched:
        patched.setattr(check_process, "LAST_WORDS", 600.0)
        patched.setattr(check_process, "SURE", 0.0)
        child = Child(ponders, limit=600.0)
        os.read(heard, 1)
        assert child.result(within=0.0).data == b"undecided"
    os.close(heard)
    os.close(tells)
    assert Child(_hangs, limit=0.3).result().data is None


def test_a_judge_that_has_hardly_begun_to_decide_at_its_limit_has_no_verdict(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard, tells = os.pipe()

    def decides() -> bytes:
        try:
            with limited(600.0):
                os.write(tells, b"!")
                time.sleep(60.0)  # the machine gives it no processor
        except Undecided:
            return b"undecided"
        return b""

    monkeypatch.setattr(check_process, "LAST_WORDS", 0.3)
    child = Child(decides, limit=600.0)
    os.read(heard, 1)
    outcome = child.result(within=0.0)
    os.close(heard)
    os.close(tells)
    assert (outcome.data, outcome.trouble) == (None, "the judge did not finish in time")
