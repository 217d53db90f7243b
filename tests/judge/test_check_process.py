"""Whatever happens to a check in a child process, the parent can say so; a verdict that takes too long is a zero."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge import check_process, evidence_files, one_check
from autograder.judge.check_process import Child, Undecided, limited
from autograder.kit.evidence import Evidence, Part
from autograder.kit.model import Criterion, Finding
from autograder.verdict import State

if TYPE_CHECKING:
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


def ponders(_: Evidence) -> Finding:
    while True:
        pass


def raises(_: Evidence) -> Finding:
    try:
        return ponders(_)
    except Exception:
        return Finding(True, "", "")


class Anybody:
    shares_participant = False
    in_a_notebook = False

    """A subject that nothing is asked of."""

    def begin(self, domain_id: int) -> None:
        del domain_id


def looked(exercise: Exercise, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Have every look bring nothing; the looks that were made."""
    looks: list[str] = []

    def look(*words: object, **_: object) -> one_check.Seen:
        looks.append(str(words[3]))
        return one_check.Seen(
            Evidence([Part("main")], evidence_files.load_reference(exercise.id)), doubtful=False
        )

    monkeypatch.setattr(one_check, "look", look)
    monkeypatch.setattr(one_check, "limited", lambda: check_process.limited(0.3))
    return looks


@pytest.mark.parametrize("judge", [ponders, raises])
def test_a_criterion_without_an_end_is_zero_with_a_reason(
    monkeypatch: pytest.MonkeyPatch, judge: object
) -> None:
    usual = exercises.get("lab_1_2.listener")
    endless = Criterion("endless", "Endless", 10, judge)  # type: ignore[arg-type]
    exercise = replace(usual, criteria=(endless,))
    looks = looked(usual, monkeypatch)
    subject: object = Anybody()
    verdict = one_check.check(
        exercise,
        subject,  # type: ignore[arg-type]
        evidence_files.load_reference(usual.id),
        seed="s",
        domain_id=0,
    ).verdict
    assert (verdict.state, verdict.score, verdict.max_score) == (State.FAILED, 0.0, 10.0)
    assert verdict.diagnosis
    assert verdict.diagnosis.key == "undecidable"
    assert len(looks) == 1  # another look would bring the same words


def test_what_is_decided_in_time_is_not_disturbed() -> None:
    with check_process.limited(0.2):
        pass
    for _ in range(2_000_000):
        pass


def test_a_decision_that_loses_the_first_word_is_told_once_more() -> None:
    """What is raised within a destructor is printed and forgotten."""
    lost = []

    def loses_the_first(evidence: Evidence) -> None:
        try:
            ponders(evidence)
        except check_process.Undecided as told:
            lost.append(told)
        ponders(evidence)

    with pytest.raises(check_process.Undecided), check_process.limited(0.05):
        loses_the_first(Evidence([], evidence_files.load_reference("lab_1_2.listener")))
    assert lost


def test_nothing_is_told_when_the_decision_is_over() -> None:
    before = signal.getsignal(check_process.STOP_SIGNAL)
    with check_process.limited(60.0):
        pass
    assert signal.getitimer(signal.ITIMER_VIRTUAL) == (0.0, 0.0)
    assert signal.getsignal(check_process.STOP_SIGNAL) == before
