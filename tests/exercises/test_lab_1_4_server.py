"""The criteria of the action server's lab on hand-made evidence: no ROS is started."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from unittest.mock import MagicMock

import pytest
from lab_1_4 import _goals
from lab_1_4 import server as lab_1_4_server
from lab_1_4._goals import (
    AGAIN,
    ALONE,
    BAD_ORDERS,
    BESIDE,
    CANCELED_ALONE,
    GOALS,
    LONG,
    LONG_ALONE,
    NEXT,
    TWINS,
    YOUNGER,
    died_of_two,
)

from autograder.kit.evidence import Event, Evidence, Part, Reference
from tests.cases import cases

FIBONACCI = [0, 1, 1, 2, 3, 5]
ACTION, TYPE = "/fibonacci", "my_robot_interfaces/action/Fibonacci"
SURVEY = Event(0.0, "interface", "graph", {"nodes": ["/n"], "action_server": {ACTION: TYPE}})


def goal(number: int, order: int, **changed: Any) -> list[Event]:
    """All that a right server sends for one goal."""
    numbers = changed.get("sequence", FIBONACCI[: order + 1])
    feedback = changed.get("feedback", [FIBONACCI[:n] for n in range(3, order + 2)])

    def event(kind: str, **data: Any) -> Event:
        return Event(0.0, kind, ACTION, {"goal": number, **data})

    accepted = changed.get("accepted", True)
    events = [event("goal_sent", fields={"order": order}), event("goal_answer", accepted=accepted)]
    if not accepted:
        return events
    events += [
        event("feedback_heard", fields={"partial_sequence": partial}, sent=changed.get("pause", 0.5) * turn)
        for turn, partial in enumerate(feedback)
    ]
    if "cancel" in changed:
        answer = {"accepted": changed["cancel"], "return_code": changed.get("return_code", 0)}
        events += [event("cancel_sent"), event("cancel_answer", **answer)]
    events.append(event("result_heard", status=changed.get("status", 4), fields={"sequence": numbers}))
    return events


def canceled(sequence: list[int], *, status: int = 5, accepted: bool = True) -> list[Event]:
    return goal(
        LONG, 20, feedback=[[0, 1, 1], [0, 1, 1, 2]], cancel=accepted, status=status, sequence=sequence
    )


RIGHT = [*goal(ALONE, 5), *goal(BESIDE, 4), *goal(AGAIN, 3), *canceled([0, 1, 1, 2, 3])]
REFUSALS = [
    *goal(0, -3, accepted=False),
    *goal(1, 47, accepted=False),
    *goal(2, 99, accepted=False),
    *goal(3, 2),
]


def evidence(goals: list[Event], bad: list[Event] | None = None) -> Evidence:
    reference = Reference("lab_1_4.server", {"action_server": {ACTION: TYPE}}, [Part(GOALS, {}, RIGHT)])
    parts = [Part(GOALS, {}, [SURVEY, *goals]), Part(BAD_ORDERS, {}, bad if bad is not None else REFUSALS)]
    return Evidence(parts, reference)


@pytest.mark.parametrize("answers", [True, False])
def test_a_node_that_answers_no_more_gets_no_bad_goals(
    answers: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[str] = []

    def run(_: object, name: str, __: object) -> bool:
        made.append(name)
        return True

    monkeypatch.setattr(_goals, "_run", run)
    events = [] if answers else [Event(9.0, "unanswered", "/fibonacci_server")]
    _goals.scenario(MagicMock(seen=lambda: Part(GOALS, {}, events)))
    assert made == ([GOALS, BAD_ORDERS] if answers else [GOALS])


def failed(seen: Evidence) -> set[str]:
    return {c.name for c in lab_1_4_server.EXERCISE.criteria if not c.judge(seen).passed}


@pytest.mark.parametrize("others", [0.00015, 0.005])
def test_a_server_without_a_pause_is_not_canceled_by_the_machine_s_being_busy(others: float) -> None:
    hurried = [
        *goal(ALONE, 5, pause=0.00015),
        *goal(BESIDE, 4, pause=others),
        *goal(AGAIN, 3, pause=others),
        *canceled([0, 1, 1, 2, 3]),
    ]
    assert failed(evidence(hurried)) == {"cancel"}
    advice = [m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(evidence(hurried))]
    assert advice[0] == "done_at_once"


@pytest.mark.parametrize(("feedback", "right"), cases(__file__, "feedback_grows_by_one_number"))
def test_feedback_grows_by_one_number(feedback: list[list[int]], right: bool) -> None:
    seen = evidence([*goal(0, 5, feedback=feedback), *RIGHT[len(goal(0, 5)) :]])
    assert ("feedback" not in failed(seen)) is right


@pytest.mark.parametrize(
    ("sequence", "status", "accepted", "right"), cases(__file__, "a_cancel_brings_the_part_that_was_computed")
)
def test_a_cancel_brings_the_part_that_was_computed(
    sequence: list[int], status: int, accepted: bool, right: bool
) -> None:
    seen = evidence(
        [
            *goal(ALONE, 5),
            *goal(BESIDE, 4),
            *goal(AGAIN, 3),
            *canceled(sequence, status=status, accepted=accepted),
        ]
    )
    assert ("cancel" not in failed(seen)) is right


def later(number: int, **changed: Any) -> list[Event]:
    """A goal that is canceled after the first one was."""
    changed = {"feedback": [[0, 1, 1]], "cancel": True, "status": 5, "sequence": [0, 1, 1], **changed}
    return goal(number, 20, **changed)


@pytest.mark.parametrize(
    ("more", "lost", "key"),
    [
        ([*later(YOUNGER), *later(LONG_ALONE), *goal(NEXT, 3)], set(), ""),
        # A busy judge may come too late for a quick server, and then asks for nothing more.
        (later(LONG_ALONE, cancel=False, return_code=3, status=4), set(), ""),
        ([*later(LONG_ALONE)[:-3], later(LONG_ALONE)[-1]], set(), ""),
        (later(LONG_ALONE, cancel=False)[:-1], {"cancel"}, ""),
        (later(LONG_ALONE, accepted=False), {"two"}, "goal_rejected"),
        ([*later(LONG_ALONE)[:-1], *goal(NEXT, 3, status=6, sequence=[])], {"two"}, "goals_mixed_up"),
        ([*later(YOUNGER)[:-1], *later(LONG_ALONE), *goal(NEXT, 3)], {"two"}, "goals_mixed_up"),
        ([*later(LONG_ALONE), *goal(NEXT, 5, feedback=[[0, 1, 1], FIBONACCI])], {"two"}, "goals_mixed_up"),
    ],
)
def test_each_goal_is_canceled_for_itself(more: list[Event], lost: set[str], key: str) -> None:
    seen = evidence([*RIGHT, *more])
    assert failed(seen) == lost
    if key:
        told = [m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(seen)]
        assert told[0] == key


@pytest.mark.parametrize(
    ("again", "is_right"),
    [({}, True), ({"cancel": False, "return_code": 3, "status": 4}, False), ({"status": 4}, False)],
)
def test_a_goal_that_was_over_before_the_request_came_is_sent_again(
    again: dict[str, Any], is_right: bool
) -> None:
    """A busy judge may ask too late, and then another goal, alone, tells whether it can be canceled."""
    too_late = {"cancel": False, "return_code": 3, "status": 4}
    right = [*goal(ALONE, 5), *goal(BESIDE, 4), *goal(AGAIN, 3)]
    seen = evidence([*right, *later(LONG, **too_late), *later(LONG_ALONE, **again)])
    assert ("cancel" not in failed(seen)) is is_right
    assert "cancel" in failed(evidence([*right, *later(LONG, **too_late)]))


def test_a_goal_that_is_canceled_only_if_it_is_alone_is_mixed_up_and_not_ignored() -> None:
    ignored = goal(LONG, 20, feedback=[[0, 1, 1], [0, 1, 1, 2]], cancel=True, sequence=FIBONACCI)
    right = [*goal(ALONE, 5), *goal(BESIDE, 4), *goal(AGAIN, 3)]
    alone = evidence([*right, *ignored, *later(LONG_ALONE)])
    never = evidence([*right, *ignored, *later(LONG_ALONE, status=4)])
    for seen, keys in ((alone, ["goals_mixed_up"]), (never, [])):
        assert [m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(seen)][:1] == keys


EXITED = Event(1.0, "subject", "exited", {"code": 0})
RAISED = Event(1.0, "subject", "raised", {"traceback": "Traceback (most recent call last):\nValueError: no"})
ALL_CRITERIA = {"action", "sequence", "feedback", "two", "cancel", "refuse"}


@pytest.mark.parametrize("sent", range(0, len(RIGHT) + 1, 3))
def test_a_program_that_ends_by_itself_earns_nothing_whenever_it_ends(sent: int) -> None:
    # Which goals come before its end is chance.
    assert failed(evidence([*RIGHT[:sent], EXITED], [])) == ALL_CRITERIA


@pytest.mark.parametrize("sent", [1, 2, len(RIGHT)])
def test_an_exception_in_a_callback_does_not_cost_the_point_for_the_server_that_was_there(sent: int) -> None:
    assert "action" not in failed(evidence([*RIGHT[:sent], RAISED], []))
    assert "action" in failed(evidence([RAISED], []))


LONG_SEQUENCE = [0, 1]
while len(LONG_SEQUENCE) <= 37:
    LONG_SEQUENCE.append(LONG_SEQUENCE[-1] + LONG_SEQUENCE[-2])


@pytest.mark.parametrize(("wrong_from", "lost"), [(33, {"sequence"}), (37, {"sequence"}), (15, {"two"})])
def test_wrong_large_numbers_cost_the_sequence_and_not_the_points_for_two_at_once(
    wrong_from: int, lost: set[str]
) -> None:
    feedback = [LONG_SEQUENCE[:n] for n in range(3, len(LONG_SEQUENCE) + 1)]
    right = goal(BESIDE, 37, feedback=feedback, sequence=LONG_SEQUENCE)
    sequence = [n + (place >= wrong_from) for place, n in enumerate(LONG_SEQUENCE)]
    told = [sequence[:n] for n in range(3, len(sequence) + 1)]
    wrong = goal(BESIDE, 37, feedback=told, sequence=sequence)
    others = [event for event in RIGHT if event.data.get("goal") != BESIDE]
    reference = Reference(
        "lab_1_4.server", {"action_server": {ACTION: TYPE}}, [Part(GOALS, {}, [*others, *right])]
    )
    seen = Evidence([Part(GOALS, {}, [SURVEY, *others, *wrong]), Part(BAD_ORDERS, {}, REFUSALS)], reference)
    assert failed(seen) == lost


def test_a_server_that_two_goals_have_ended_is_asked_to_cancel_in_a_run_of_its_own() -> None:
    seen = evidence([*goal(ALONE, 5), *goal(TWINS[0], 2)[:1], RAISED])
    assert died_of_two(seen.main)
    assert "cancel" in failed(seen)
    alone = [replace(e, data={**e.data, "goal": LONG_ALONE}) for e in canceled([0, 1, 1, 2, 3])]
    with_run = replace(seen, parts=[*seen.parts, Part(CANCELED_ALONE, {}, [SURVEY, *alone])])
    assert "cancel" not in failed(with_run)
    for whole in (evidence(RIGHT), evidence([*RIGHT, RAISED]), evidence([*goal(ALONE, 5), RAISED])):
        assert not died_of_two(whole.main)


@pytest.mark.parametrize(("ended", "told"), [(1.2, True), (9.0, False)])
def test_feedback_after_the_end_is_worth_a_remark(ended: float, told: bool) -> None:
    said = Event(0.0, "goal_ended", ACTION, {"goal": ALONE, "status": 4, "sent": ended})
    seen = evidence([*RIGHT, said])
    assert any(remark(seen) for remark in lab_1_4_server.EXERCISE.remarks) is told
    assert not failed(seen)


def test_a_goal_that_was_over_before_the_cancel_is_told_so_where_its_result_was_not_seen() -> None:
    *events, _ = goal(LONG, 20, feedback=[FIBONACCI[:n] for n in (3, 4, 5)], pause=0.0002)
    events.append(Event(0.0, "cancel_answer", ACTION, {"goal": LONG, "accepted": False, "return_code": 3}))
    seen = evidence(
        [
            *goal(ALONE, 5, pause=0.0002),
            *goal(BESIDE, 4, pause=0.0002),
            *goal(AGAIN, 3, pause=0.0002),
            *events,
        ]
    )
    assert next(m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(seen)) == "done_at_once"


def test_a_server_without_a_pause_whose_last_number_was_out_when_it_agreed_to_cancel_has_not_ignored_that() -> (
    None
):
    quick = [*goal(ALONE, 5, pause=0.001), *goal(BESIDE, 4, pause=0.001), *goal(AGAIN, 3, pause=0.001)]
    last = goal(LONG, 20, feedback=[FIBONACCI[:n] for n in (3, 4, 5)], pause=0.001, cancel=True, status=4)
    seen = evidence([*quick, *last])
    assert next(m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(seen)) == "done_at_once"


def test_a_server_without_a_pause_of_which_chance_canceled_one_goal_does_not_mix_goals_up() -> None:
    quick = [*goal(ALONE, 5, pause=0.001), *goal(BESIDE, 4, pause=0.001), *goal(AGAIN, 3, pause=0.001)]
    feedback = [FIBONACCI[:n] for n in (3, 4, 5)]
    first = goal(LONG, 20, feedback=feedback, pause=0.001, cancel=True, status=4)
    seen = evidence([*quick, *first, *later(LONG_ALONE)])
    assert failed(seen) == {"cancel"}
    assert next(m.key for m in lab_1_4_server.EXERCISE.mistakes if m.recognize(seen)) == "done_at_once"


def test_feedback_that_was_sent_long_after_the_cancel_was_answered_shows_that_the_server_worked_on() -> None:
    def seen(rounds: int) -> Evidence:
        feedback = [FIBONACCI[:n] for n in (3, 4, 5, 6)]
        events = goal(LONG, 20, feedback=feedback, pause=1.0, cancel=True, status=5, sequence=FIBONACCI)
        answer = next(event for event in events if event.kind == "cancel_answer")
        events[events.index(answer)] = Event(
            0.0, answer.kind, ACTION, {**answer.data, "arrived": 3.5 - rounds}
        )
        return evidence([*RIGHT[: -len(canceled([]))], *events])

    # One number of the round that it was in, and one of the next one, where it had looked already.
    assert "cancel" not in failed(seen(2))
    assert "cancel" in failed(seen(3))


def test_feedback_that_was_sent_when_the_result_had_been_heard_does_not_count() -> None:
    *events, result = goal(ALONE, 5, pause=1.0)
    for arrived, right in ((3.5, True), (2.5, True), (1.5, False)):
        ended = Event(0.0, result.kind, ACTION, {**result.data, "arrived": arrived})
        seen = evidence([*events, ended, *RIGHT[len(events) + 1 :]])
        assert ("feedback" not in failed(seen)) is right


def test_a_busy_thread_that_reads_no_second_goal_costs_the_points_of_two_at_once_only() -> None:
    *events, _ = canceled([])
    unread = [event for event in events if event.kind != "cancel_answer"]
    seen = evidence([*goal(ALONE, 5), *unread, *goal(BESIDE, 4)[:1]])
    assert failed(seen) == {"two", "cancel"}


def test_a_goal_that_has_feedback_only_the_first_time_finds_what_an_earlier_one_stored() -> None:
    """In the second look all goals find it, if it is stored outside of the class."""

    def told(seen: Evidence) -> str:
        found = (one.recognize(seen) for one in lab_1_4_server.EXERCISE.mistakes)
        return next((advice.text for advice in found if advice), "")

    stored = "what one goal stored is still there for the next one"
    silent = evidence(
        [*goal(ALONE, 4, feedback=[]), *goal(BESIDE, 4), *goal(AGAIN, 4, feedback=[]), *canceled([])]
    )
    assert stored in told(silent)
    in_the_module = evidence([*goal(ALONE, 5, feedback=[]), *goal(AGAIN, 5, feedback=[]), *canceled([])])
    assert stored not in told(in_the_module)
    assert stored in told(replace(in_the_module, before=evidence(RIGHT)))
