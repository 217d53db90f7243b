"""Where a run leaves the reference solution's: kinds of events, how many of them, and how they came out."""

from __future__ import annotations

import pytest

from autograder.authoring.answer_bank import answers
from autograder.judge import evidence_files
from autograder.judge.timeline.parting_point import (
    LONGEST_LINE,
    PartingPoint,
    claimed,
    own_lines_in_words,
    parting_point,
)
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.messages.judge_messages import OwnLine
from tests.cases import cases
from tests.measure import evidence as kept_evidence

ACTION = "/fibonacci"
REFERENCE = Reference("x", {})


def _goal(order: int, feedback: int, *, status: int = 4, accepted: bool = True) -> list[Event]:
    sent = Event(0.0, "goal_sent", ACTION, {"goal": 0, "fields": {"order": order}})
    told = [
        Event(0.2, "feedback_heard", ACTION, {"goal": 0, "fields": {"n": number}})
        for number in range(feedback)
    ]
    ended = Event(0.3, "result_heard", ACTION, {"goal": 0, "status": status, "fields": {"n": order}})
    return [sent, Event(0.1, "goal_answer", ACTION, {"goal": 0, "accepted": accepted}), *told, ended]


def _point(mine: list[Event], reference: list[Event]) -> PartingPoint | None:
    return parting_point(
        Evidence([Part("goals", {}, mine)], Reference("x", {}, [Part("goals", {}, reference)]))
    )


def _parted(mine: list[Event], reference: list[Event]) -> str:
    return _text(_point(mine, reference))


def _text(point: PartingPoint | None) -> str:
    return point.text if point else ""


def test_a_run_of_the_same_kinds_does_not_part() -> None:
    assert _parted(_goal(4, 3), _goal(4, 3)) == ""
    assert _parted(_goal(5, 4), _goal(4, 3)) == ""


@pytest.mark.parametrize(
    ("mine", "says"),
    [
        (
            _goal(4, 0),
            "until the goal is accepted, your run is as asked. Then: no feedback. Asked: feedback 0.",
        ),
        (
            _goal(5, 0),
            "until the goal is accepted, your run is as asked. Then: no feedback. Asked: feedback 0.",
        ),
        (_goal(4, 4), "until feedback 2, your run is as asked. Then: feedback 3. Asked: no more feedback."),
        (_goal(4, 2), "until feedback 1, your run is as asked. Then: no more feedback. Asked: feedback 2."),
        (_goal(4, 3, status=6), "Then: the result ABORTED 4. Asked: the result SUCCEEDED 4."),
        (_goal(4, 3)[:-1], "Then: no result. Asked: the result SUCCEEDED 4."),
        (
            _goal(4, 3, accepted=False),
            "until goal, order 4, your run is as asked. Then: the goal is rejected.",
        ),
    ],
    ids=[
        "no feedback",
        "another order",
        "one too many",
        "one too few",
        "another status",
        "no result",
        "rejected",
    ],
)
def test_the_first_event_that_differs_is_told(mine: list[Event], says: str) -> None:
    assert says in _parted(mine, _goal(4, 3))


def test_feedback_that_overtakes_the_answer_to_its_goal_is_no_difference() -> None:
    sent, answer, first, *rest = _goal(4, 3)
    assert _parted([sent, first, answer, *rest], _goal(4, 3)) == ""


@pytest.mark.parametrize(
    ("mine", "lines", "says"),
    [
        (_goal(4, 0), ["succeed"], "No line of your cell uses `publish_feedback`."),
        (_goal(4, 4), ["publish_feedback"], "Line 1 of your cell: `it.publish_feedback()`."),
        (_goal(4, 3, status=6), ["abort", "succeed"], "Line 1 of your cell: `it.abort()`."),
        (_goal(4, 3, status=6), ["other"], "No line of your cell uses `succeed`."),
        (_goal(4, 3)[:-1], ["succeed"], "Line 1 of your cell: `it.succeed()`."),
    ],
)
def test_the_students_line_that_causes_the_first_difference_is_quoted(
    mine: list[Event], lines: list[str], says: str
) -> None:
    point = _point(mine, _goal(4, 3))
    assert point is not None
    own = [OwnLine(name, "your cell", number, f"it.{name}()") for number, name in enumerate(lines, 1)]
    assert own_lines_in_words(Evidence([Part("x", {}, claimed(point.causes, own))], REFERENCE)) == says


def test_of_claimed_lines_two_are_quoted_each_cut_and_within_its_quotation() -> None:
    line = OwnLine("publish", "`your cell`", 7, "`" + "x" * 1000)
    quoted = {"place": "'your cell'", "number": 7, "text": "'" + "x" * (LONGEST_LINE - 1)}
    assert [event.data for event in claimed([["publish"]], [line] * 2)] == [quoted] * 2


@pytest.mark.parametrize(("uses", "shown"), [(1, 1), (2, 2), (3, 0)])
def test_of_more_lines_than_a_card_shows_none_is_quoted(uses: int, shown: int) -> None:
    lines = [OwnLine("publish", "your cell", number, "it.publish()") for number in range(1, uses + 1)]
    assert len(claimed([["publish"]], lines)) == shown


def _talking(texts: list[str]) -> Part:
    events = [
        Event(0.5 * n, "message", "/chatter", {"fields": {"data": text}}, sim=0.5 * n)
        for n, text in enumerate(texts)
    ]
    return Part("talking", {}, events)


@pytest.mark.parametrize(
    ("texts", "says"), cases(__file__, "a_message_that_does_not_come_is_told_with_the_one_that_is_due")
)
def test_a_message_that_does_not_come_is_told_with_the_one_that_is_due(texts: list[str], says: str) -> None:
    reference = Reference("x", {}, [_talking(["0", "1", "2", "3"])])
    assert says in _text(parting_point(Evidence([_talking(texts)], reference)))


def test_a_topic_on_which_much_came_says_nothing_of_its_end() -> None:
    reference = Reference("x", {}, [_talking(["0", "1", "2", "3", "4"])])
    assert parting_point(Evidence([_talking(["0", "1", "2"])], reference)) is None


def test_hardly_a_right_answer_of_the_bank_parts() -> None:
    """A criterion may allow for more than the reference solution does: here one feedback message more."""
    parted = []
    for answer in answers():
        if answer.diagnoses:
            continue
        record = kept_evidence.record_of(answer, kept_evidence.kept(answer.exercise).get(answer.name))
        evidence = evidence_files.evidence_of(record.seen, evidence_files.load_reference(answer.exercise))
        if parting_point(evidence):
            parted.append(answer.name)
    assert len(parted) <= 3, parted
