"""One check: when a subject is looked at a second time, in real time, and which look counts."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import pytest

from autograder import exercises, own_lines
from autograder.cards.text_rendering import card_text
from autograder.judge import evidence_files, machine_fitness, one_check
from autograder.judge.bench.bench import TestBench
from autograder.judge.bench.unreadable import NAME
from autograder.judge.machine_fitness import ANSWER_WITHIN, Crowding, NotDelivered, TooBusy
from autograder.judge.verdicts import deciding
from autograder.judge.verdicts.exercise_faults import NOT_THE_EXERCISE, WHAT_TO_DO, ExerciseFailed
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.mistakes import hangs
from autograder.kit.model import Advice, Criterion, Finding, Mistake
from autograder.kit.rules import value
from autograder.verdict import State, not_checked

if TYPE_CHECKING:
    from autograder.kit.model import Exercise
    from autograder.messages.judge_messages import OwnLine
    from autograder.verdict import Verdict


FAST, REAL = Pace.FAST, Pace.REAL_TIME
USUAL = exercises.get("lab_1_2.listener")


class Anybody:
    in_a_notebook = True
    is_building = False
    busy = 2 * hangs.LOOPS

    def __init__(self, stacks: str = "") -> None:
        self.told: list[str] = []
        self._stacks = stacks

    def stack(self) -> str:
        return self._stacks

    def begin(self, domain_id: int) -> None:
        del domain_id

    def tell_so_far(self, verdict: Verdict, words: str) -> None:
        assert verdict.state is State.CHECKING
        self.told.append(words)

    def own_lines(self) -> list[OwnLine]:
        return []


def exercise(*, certain: bool = False, second_look: bool = True) -> Exercise:
    """One whose criterion holds where the part is called good."""

    def judge(evidence: Evidence) -> Finding:
        return Finding(evidence.main.name == "good", "", "")

    mistake = Mistake("mistake", lambda _: Advice("It says b.", ""), certain=certain)
    criterion = Criterion("good", "Good", 10, judge)
    return replace(USUAL, criteria=(criterion,), mistakes=(mistake,), second_look=second_look)


@pytest.mark.parametrize(
    ("judged", "seen", "looks", "passed"),
    [
        pytest.param(exercise(), ["good"], [FAST], True, id="a fast pass counts"),
        pytest.param(exercise(), ["bad", "good"], [FAST, REAL], True, id="what fails is looked at again"),
        pytest.param(exercise(), ["bad", "bad"], [FAST, REAL], False, id="and may fail again"),
        pytest.param(exercise(certain=True), ["bad"], [FAST], False, id="not where a mistake is certain"),
        pytest.param(exercise(second_look=False), ["bad"], [FAST], False, id="nor where nobody looks twice"),
        pytest.param(exercise(), ["doubtful", "good"], [FAST, REAL], True, id="a doubtful pass is confirmed"),
        pytest.param(exercise(), ["doubtful", "bad"], [FAST, REAL], False, id="or not"),
        pytest.param(
            exercise(), ["unanswered", "bad"], [FAST, REAL], False, id="so is one that was cut short"
        ),
    ],
)
def test_the_last_look_that_is_needed_decides(
    monkeypatch: pytest.MonkeyPatch, judged: Exercise, seen: list[str], looks: list[Pace], passed: bool
) -> None:
    made: list[Pace] = []
    stored = evidence_files.load_reference(USUAL.id)

    def look(*words: Any, **_: object) -> one_check.Seen:
        name = seen[len(made)]
        made.append(words[3])
        silent = [Event(0.1, "unanswered", "/node", {"text": ""})] if name == "unanswered" else []
        part = Part("good" if name in ("doubtful", "unanswered") else name, {}, silent)
        return one_check.Seen(Evidence([part], stored), doubtful=name == "doubtful")

    monkeypatch.setattr(one_check, "look", look)
    monkeypatch.setattr(Crowding, "too_busy", False)  # whatever else this machine does
    subject: Any = Anybody()
    checked = one_check.check(judged, subject, stored, seed="s", domain_id=0)
    assert made == looks
    assert checked.verdict.passed is passed
    assert (checked.evidence.before is not None) is (len(looks) == 2)


@pytest.mark.parametrize(("first", "doubtful"), [("bad", False), ("bad", True), ("good", True)])
def test_a_look_that_goes_as_the_first_one_leaves_its_verdict(
    monkeypatch: pytest.MonkeyPatch, first: str, doubtful: bool
) -> None:
    """Only if it was in doubt may it be a busy machine that fails twice."""
    stored = evidence_files.load_reference(USUAL.id)
    looks = iter([(first, False), ("cut short", True)])

    def look(*_: Any, **__: object) -> one_check.Seen:
        name, confirms = next(looks)
        return one_check.Seen(Evidence([Part(name)], stored), doubtful, confirms=confirms)

    monkeypatch.setattr(one_check, "look", look)
    monkeypatch.setattr(Crowding, "too_busy", True)
    subject: Any = Anybody()
    checked = one_check.check(exercise(), subject, stored, seed="s", domain_id=0, marks_crowded=True)
    assert (checked.evidence.main.name, checked.evidence.before) == (first, None)
    assert checked.verdict.passed is (first == "good")
    assert checked.crowded is (first == "bad" and doubtful)
    assert next(looks, None) is None


@pytest.mark.parametrize(
    ("judged", "seen", "too_busy", "crowded"),
    [
        pytest.param(exercise(), ["bad", "bad"], True, True, id="the machine was crowded"),
        pytest.param(exercise(), ["bad", "bad"], False, False, id="it was not"),
        pytest.param(exercise(), ["bad", "good"], True, False, id="a pass is a pass"),
        pytest.param(exercise(certain=True), ["bad"], True, False, id="as a mistake that is certain"),
        pytest.param(exercise(), ["bad", "unmet"], False, True, id="it had not met what is there"),
        pytest.param(exercise(certain=True), ["unmet"], False, False, id="which no certain mistake needs"),
    ],
)
def test_a_failure_that_may_be_the_machines_is_marked(
    monkeypatch: pytest.MonkeyPatch, judged: Exercise, seen: list[str], too_busy: bool, crowded: bool
) -> None:
    stored = evidence_files.load_reference(USUAL.id)
    looks = iter(seen)

    def look(*_: Any, **__: object) -> one_check.Seen:
        name = next(looks)
        part = Part("bad" if name == "unmet" else name)
        return one_check.Seen(Evidence([part], stored), doubtful=False, unmet=name == "unmet")

    monkeypatch.setattr(one_check, "look", look)
    monkeypatch.setattr(Crowding, "too_busy", too_busy)
    subject: Any = Anybody()
    checked = one_check.check(judged, subject, stored, seed="s", domain_id=0, marks_crowded=True)
    assert checked.crowded is crowded


def test_who_checks_by_hand_is_told_that_the_machine_is_too_busy_to_tell(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stored = evidence_files.load_reference(USUAL.id)
    seen = one_check.Seen(Evidence([Part("bad")], stored), doubtful=False)
    monkeypatch.setattr(one_check, "look", lambda *_, **__: seen)
    monkeypatch.setattr(Crowding, "too_busy", True)
    subject: Any = Anybody()
    with pytest.raises(TooBusy, match="The machine is too busy"):
        one_check.check(exercise(), subject, stored, seed="s", domain_id=0)


@pytest.mark.parametrize("place", ["criteria", "mistakes"])
@pytest.mark.parametrize("with_solution", [True, False], ids=["with the solution, too", "with the subject"])
def test_an_exception_of_the_exercise_is_no_trouble_of_the_moment(
    monkeypatch: pytest.MonkeyPatch, place: str, with_solution: bool
) -> None:
    """Such a check has no verdict, and only what fails with the solution, too, is the exercise's fault."""

    def fails(evidence: Evidence) -> Any:
        if with_solution or evidence.main.name == "bad":
            return value(Event(0.0, "message", "/any", {}))  # a line of the kit, as an author calls it
        return Finding(False, "", "") if place == "criteria" else None

    stored = evidence_files.load_reference(USUAL.id)
    seen = one_check.Seen(Evidence([Part("bad")], stored), doubtful=False)
    monkeypatch.setattr(one_check, "look", lambda *_, **__: seen)
    if place == "criteria":
        judged = replace(exercise(), criteria=(Criterion("good", "Good", 10, fails),))
    else:
        judged = replace(exercise(), mistakes=(Mistake("mistake", fails),))
    subject: Any = Anybody()
    with pytest.raises(ExerciseFailed, match=r"KeyError: 'fields' \(rules\.py, line \d+\)") as failed:
        one_check.check(judged, subject, stored, seed="s", domain_id=0)
    card = card_text(not_checked(judged.id, judged.title, 10, str(failed.value)))
    shown = " ".join(card.split())
    assert (WHAT_TO_DO in shown, NOT_THE_EXERCISE in shown) == (with_solution, not with_solution)
    assert ("The exercise has a fault" in shown) is with_solution
    assert "again" not in card


@pytest.mark.parametrize("error", [ValueError("planted"), UnicodeDecodeError("utf-8", b"", 0, 1, "planted")])
def test_an_exception_of_the_bench_is_no_verdict(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(TestBench, "part", fails)
    subject: Any = Anybody()
    subject.shares_participant = True
    with pytest.raises((ExerciseFailed, type(error)), match="planted"):
        one_check.check(
            USUAL, subject, evidence_files.load_reference(USUAL.id), seed="s", domain_id=0, marks_crowded=True
        )


def test_an_unreadable_subject_has_no_points_and_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    stored = evidence_files.load_reference(USUAL.id)
    seen = one_check.Seen(
        Evidence([Part("good", {}, [Event(0.1, "unreadable", NAME)])], stored), doubtful=False
    )
    monkeypatch.setattr(one_check, "look", lambda *_, **__: seen)
    subject: Any = Anybody()
    checked = one_check.check(exercise(), subject, stored, seed="s", domain_id=0)
    assert (checked.verdict.state, checked.verdict.score) == (State.FAILED, 0.0)
    assert checked.verdict.diagnosis is not None
    assert "a name that ROS does not allow" in checked.verdict.diagnosis.text
    assert replace(deciding.decide(exercise(), checked.evidence, "s"), seconds=checked.verdict.seconds) == (
        checked.verdict
    )


class BusyFor:
    """Stands in for the machine and the bench: each look lasts so many seconds, on a machine that is busy."""

    def __init__(self, *seconds: float) -> None:
        self._seconds, self._now = iter(seconds), 0.0
        self.stored = evidence_files.load_reference(USUAL.id)

    def hurry(self, **how: Any) -> machine_fitness.Hurry:
        return machine_fitness.Hurry(lambda: 16, 2, lambda: self._now, **how)

    def look(self, *_: Any, hurry: Any, card: Any, **__: Any) -> one_check.Seen:
        if card is not None:
            card.begin(Evidence([], self.stored))
        self._now += next(self._seconds)
        hurry()
        return one_check.Seen(Evidence([Part("bad")], self.stored), doubtful=False)


@pytest.mark.parametrize(
    ("seconds", "known"),
    [((ANSWER_WITHIN + 1,), False), ((5.0, ANSWER_WITHIN), True)],
    ids=["in the first look", "in the second one, which leaves what the first one saw"],
)
def test_who_waits_on_a_busy_machine_is_told_what_is_known(
    monkeypatch: pytest.MonkeyPatch, seconds: tuple[float, ...], known: bool
) -> None:
    busy, subject = BusyFor(*seconds), Anybody()
    monkeypatch.setattr(one_check, "Hurry", busy.hurry)
    monkeypatch.setattr(one_check, "look", busy.look)
    with pytest.raises(TooBusy, match="The machine is too busy") as raised:
        one_check.check(exercise(), cast("Any", subject), busy.stored, seed="s", domain_id=0)
    assert ("It says b." in str(raised.value)) is known
    assert ["It says b." in words for words in subject.told] == [False, True][: 1 + known]


def test_a_mistake_that_a_whole_look_proves_ends_a_check_with_its_verdict_however_busy_the_machine_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    busy = BusyFor(5.0, ANSWER_WITHIN)
    monkeypatch.setattr(one_check, "Hurry", busy.hurry)
    monkeypatch.setattr(one_check, "look", busy.look)
    # With the subject's own names, a second look would decide the criteria that a wrong name has spoiled.
    monkeypatch.setattr(one_check, "misnamed", lambda *_: {"/a": {"real": "/b", "costs": "good"}})
    verdict = one_check.check(
        exercise(certain=True), cast("Any", Anybody()), busy.stored, seed="s", domain_id=0
    ).verdict
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.text == "It says b."
    assert verdict.remarks == (one_check.CUT,)


LOOP = 'Thread 0x1 in the loop of line 3: while self.left:{} (most recent call first):\n  File "cell", line 4 in dock'


@pytest.mark.parametrize(
    ("stack", "mistake", "proves"),
    [
        (LOOP.format(own_lines.ENDLESS), hangs.ENDLESS_LOOP, True),
        (LOOP.format(""), hangs.ENDLESS_LOOP, False),
        (LOOP.format(own_lines.ENDLESS), replace(hangs.ENDLESS_LOOP, certain=False), False),
        (LOOP.format(""), Mistake("silent", lambda _: Advice("It is silent.", ""), certain=True), False),
    ],
    ids=[
        "a loop without an end",
        "a loop that may end",
        "one that proves nothing",
        "what needs a whole look",
    ],
)
def test_of_a_look_that_a_busy_machine_cuts_only_an_endless_loop_is_proven(
    monkeypatch: pytest.MonkeyPatch, stack: str, mistake: Mistake, proves: bool
) -> None:
    busy, subject = BusyFor(ANSWER_WITHIN + 1), Anybody(stack)
    monkeypatch.setattr(one_check, "Hurry", busy.hurry)
    monkeypatch.setattr(one_check, "look", busy.look)
    judged = replace(exercise(), mistakes=(mistake,))
    with contextlib.nullcontext() if proves else pytest.raises(TooBusy, match="The machine is too busy"):
        checked = one_check.check(judged, cast("Any", subject), busy.stored, seed="s", domain_id=0)
        assert (checked.verdict.state, checked.verdict.remarks) == (State.FAILED, (one_check.CUT,))
        assert checked.verdict.diagnosis is not None
        assert "the loop of line 3: `while self.left:`" in checked.verdict.diagnosis.text


def test_a_grader_lets_a_check_take_its_time_and_a_submission_hears_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    busy, subject = BusyFor(100.0, 100.0), Anybody()
    monkeypatch.setattr(one_check, "Hurry", busy.hurry)
    monkeypatch.setattr(one_check, "look", busy.look)
    checked = one_check.check(
        exercise(), cast("Any", subject), busy.stored, seed="s", domain_id=0, marks_crowded=True
    )
    assert not checked.verdict.passed
    assert subject.told == []


@pytest.mark.parametrize("when", [[False, True], [True, False]], ids=["before", "after"])
def test_silence_proves_nothing_where_the_machine_loses_messages(
    monkeypatch: pytest.MonkeyPatch, when: list[bool]
) -> None:
    stored = evidence_files.load_reference(USUAL.id)
    subject: Any = Anybody()
    monkeypatch.setattr(Crowding, "too_busy", False)

    def checked(judged: Exercise, name: str) -> bool:
        seen = one_check.Seen(Evidence([Part(name)], stored), doubtful=False)
        monkeypatch.setattr(one_check, "look", lambda *_, **__: seen)
        monkeypatch.setattr(one_check, "delivers", iter(when).__next__)
        return one_check.check(judged, subject, stored, seed="s", domain_id=0).verdict.passed

    assert checked(exercise(), "good")
    assert not checked(exercise(certain=True), "bad")
    with pytest.raises(NotDelivered, match="delivers no messages"):
        checked(exercise(), "bad")


@pytest.mark.parametrize(("name", "missed"), [("good", False), ("bad", True)])
def test_a_card_shows_what_was_expected_only_where_something_is_missing(name: str, missed: bool) -> None:
    stored = evidence_files.load_reference("lab_1_2.talker")
    stored = replace(stored, parts=[replace(stored.part("talking"), name=name)])
    verdict = deciding.judge(exercise(), Evidence([Part(name)], stored), "seed")
    assert any(moment.direction == "expected" for moment in verdict.timeline) is missed
