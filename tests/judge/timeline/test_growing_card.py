"""The card of a check that goes on: what it shows is decided for good."""

from __future__ import annotations

from dataclasses import replace

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.judge.timeline.growing_card import GrowingCard, RunToCome, StillToCome, so_far
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.model import Criterion, Exercise, Finding
from autograder.verdict import CriterionResult, State, Verdict

STORED = evidence_files.load_reference("lab_1_3.client")
LATE, BIASED, EXTREME, ABSENT = (part.name for part in STORED.parts)
GOOD = [Event(0.1, "output", "stdout", {"text": "good"})]


def says_good(*names: str) -> Criterion:
    """One that holds if the named runs said good; without names, if all runs did."""

    def judge(evidence: Evidence) -> Finding:
        runs = [evidence.part(name) for name in names] or evidence.parts
        return Finding(all(run.said() == ["good"] for run in runs), "", "")

    return Criterion(" ".join(names) or "all", "Says good", 2, judge)


def decided(_: Exercise, criterion: Criterion, evidence: Evidence) -> CriterionResult:
    return CriterionResult(criterion.name, criterion.title, 2, criterion.judge(evidence).passed, "", "")


def cards(*looks: Evidence) -> list[Verdict]:
    shown: list[Verdict] = []
    criteria = (says_good(LATE), says_good(LATE, BIASED), says_good(EXTREME, ABSENT), says_good())
    card = GrowingCard(
        replace(exercises.get("lab_1_3.client"), criteria=criteria), decided, lambda one, _: shown.append(one)
    )
    for look in looks:
        card.begin(look)
    return shown


def look(real_time: bool = False, **said: list[Event]) -> Evidence:
    names = {"late": LATE, "biased": BIASED, "extreme": EXTREME, "absent": ABSENT}
    return Evidence([Part(names[name], {}, events) for name, events in said.items()], STORED, real_time)


def test_a_criterion_is_met_as_soon_as_all_runs_that_it_asks_for_have_ended() -> None:
    first, second, third = cards(look(), look(late=GOOD), look(late=GOOD, biased=GOOD))
    assert [one.passed for one in first.criteria] == [None] * 4
    assert [one.passed for one in second.criteria] == [True, None, None, None]
    assert [one.passed for one in third.criteria] == [True, True, None, None]
    assert (third.state, third.score, third.max_score) == (State.CHECKING, 4.0, 8.0)


def test_what_is_not_met_waits_for_the_verdict_as_the_second_look_may_find_it_met() -> None:
    (card,) = cards(look(late=[]))
    assert [one.passed for one in card.criteria] == [None] * 4


def test_what_a_card_has_shown_stays_in_the_second_look() -> None:
    _, begun, again = cards(look(late=GOOD), look(real_time=True), look(real_time=True, late=[]))
    assert begun.criteria[0].passed
    assert again.criteria[0].passed
    assert again.diagnosis is not None
    assert "the judge looks again, in real time" in again.diagnosis.text


def test_a_wrong_name_decides_nothing_early_as_it_fails_a_criterion_that_is_met_otherwise() -> None:
    (card,) = cards(look(late=[Event(0.0, "misnamed", "/a", {"real": "/b", "costs": LATE}), *GOOD]))
    assert card.score == 0


def test_a_card_says_which_runs_have_ended_and_which_are_still_to_come() -> None:
    first, second = cards(look(), look(absent=GOOD, late=GOOD))
    assert first.diagnosis is not None
    assert second.diagnosis is not None
    assert first.diagnosis.text == "The judge watches your code."
    assert second.diagnosis.text == (
        f"Runs that have ended: “{LATE}”; “{ABSENT}”. Still to come: “{BIASED}”; “{EXTREME}”."
    )


@pytest.mark.parametrize("ask", ["events", "inputs"])
def test_of_a_run_to_come_only_the_name_is_known(ask: str) -> None:
    run = so_far(look(late=GOOD)).part(BIASED)
    assert isinstance(run, RunToCome)
    with pytest.raises(StillToCome):
        getattr(run, ask)
