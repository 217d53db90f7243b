"""Whatever happens to a check in a child process, the parent can say so; too much to judge is a zero."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge import evidence_files, one_check
from autograder.judge.bench.recorder import MAX_EVENTS
from autograder.judge.check_process import Child
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.model import Exercise


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


@pytest.mark.parametrize(("does", "words"), [(_raises, "code 1"), (_dies, "signal 9")])
def test_a_child_that_comes_to_a_bad_end_has_no_verdict(does: Callable[[], bytes], words: str) -> None:
    outcome = Child(does, limit=60.0).result()
    assert (outcome.data, words in outcome.trouble) == (None, True)


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


def test_a_judge_that_is_deciding_at_its_limit_has_no_verdict() -> None:
    """However slow the processor is, no limit in seconds gives zero points."""

    def decides() -> bytes:
        while True:
            pass

    outcome = Child(decides, limit=0.3).result()
    assert (outcome.data, outcome.trouble) == (None, "the judge did not finish in time")


class Anybody:
    shares_participant = False
    in_a_notebook = False

    """A subject that nothing is asked of."""

    def begin(self, domain_id: int) -> None:
        del domain_id


def with_events(exercise: Exercise, count: int, kind: str) -> Evidence:
    """Evidence of one part with so many events of a kind."""
    event = Event(1.0, kind, "chatter", {"text": "a"})
    return Evidence([Part("main", events=[event] * count)], evidence_files.load_reference(exercise.id))


def test_more_events_than_the_judge_reads_are_zero_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    exercise = exercises.get("lab_1_2.listener")
    looks: list[str] = []

    def look(*words: object, **_: object) -> one_check.Seen:
        looks.append(str(words[3]))
        return one_check.Seen(with_events(exercise, MAX_EVENTS + 1, "matched"), doubtful=False)

    monkeypatch.setattr(one_check, "look", look)
    subject: object = Anybody()
    verdict = one_check.check(
        exercise,
        subject,  # type: ignore[arg-type]
        evidence_files.load_reference(exercise.id),
        seed="s",
        domain_id=0,
    ).verdict
    assert (verdict.state, verdict.score, verdict.max_score) == (State.FAILED, 0.0, 10.0)
    assert verdict.diagnosis
    assert verdict.diagnosis.key == "undecidable"
    assert len(looks) == 1  # another look would bring the same events
    assert deciding.decide(exercise, with_events(exercise, MAX_EVENTS + 1, "matched"), "s") == replace(
        verdict, seconds=0.0
    )


def test_as_many_events_as_the_judge_reads_are_judged() -> None:
    exercise = exercises.get("lab_1_2.listener")
    verdict = deciding.decide(exercise, with_events(exercise, MAX_EVENTS, "parameters"), "s")
    assert verdict.diagnosis
    assert verdict.diagnosis.key != "undecidable"
