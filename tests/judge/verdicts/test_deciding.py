"""A decision that does not come to its end is a zero with a reason, and no trouble of the grader's."""

from __future__ import annotations

import signal
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge import check_process, evidence_files, one_check
from autograder.kit.evidence import Evidence, Part
from autograder.kit.model import Criterion, Finding
from autograder.verdict import State

if TYPE_CHECKING:
    from autograder.kit.model import Exercise


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
