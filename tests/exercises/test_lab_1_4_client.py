"""What counts as saying that a goal was rejected or aborted, or what its result was: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import INTERRUPTED, Event, Evidence, Part, Reference
from autograder.kit.goal_reports import (
    ABORTED,
    LATE,
    REFUSED,
    aborted_as_seen,
    cancels_unasked,
    refused_as_seen,
    reports_result,
    returned_instead,
    unshown_feedback,
)
from autograder.kit.mistakes.goal_mistakes import NOT_RETURNED
from tests.cases import cases

REFERENCE = Reference(
    "lab_1_4.client", {"action_client": {"/fibonacci": "my_robot_interfaces/action/Fibonacci"}}
)
NUMBERS = [100_001, 200_002, 300_003]


def say(text: str) -> Event:
    return Event(0.0, "output", "stdout", {"text": text})


GOAL = Event(0.0, "goal", "/fibonacci", {"fields": {"order": 12}})
ASKED = Event(0.0, "result_request", "/fibonacci", {"known": True})
ENDED = Event(0.0, "subject", "exited", {"code": 0})


def result(status: str, numbers: list[int]) -> Event:
    return Event(0.0, "result", "/fibonacci", {"status": status, "fields": {"sequence": numbers}})


def feedback(*numbers: int) -> Event:
    return Event(0.0, "feedback", "/fibonacci", {"fields": {"partial_sequence": list(numbers)}})


def evidence(success: str, *others: Part) -> Evidence:
    answered = Event(0.0, "goal_answered", "/fibonacci")
    end = [ASKED, result("succeeded", NUMBERS), say(success), ENDED]
    return Evidence([Part(LATE, {}, [GOAL, say("goal sent"), answered, *end]), *others], REFERENCE)


def returned(name: str, value: str, *events: Event) -> Part:
    return Part(name, {}, [GOAL, *events, Event(0.0, "subject", "returned", {"value": value})])


@pytest.mark.parametrize(
    ("value", "rejected", "words"),
    [
        (str(NUMBERS), "[]", ""),
        (f"'{NUMBERS}'", "[]", "but should return the sequence of its goal's result as a list"),
        ("3", "[]", "returns 3"),
        (str(NUMBERS), "None", "returns None, but should return an empty list if its goal is rejected"),
        (str(NUMBERS), "[0]", "returns [0], but should return an empty list"),
    ],
)
def test_a_function_that_returns_another_value_is_told_which(value: str, rejected: str, words: str) -> None:
    late = returned(LATE, value, ASKED, result("succeeded", NUMBERS))
    advice = NOT_RETURNED.recognize(Evidence([late, returned(REFUSED, rejected)], REFERENCE))
    assert (words in advice.text) if advice else not words


@pytest.mark.parametrize(
    ("success", "aborted", "told"),
    cases(__file__, "an_abort_is_told_by_its_name_or_by_the_number_of_its_status"),
)
def test_an_abort_is_told_by_its_name_or_by_the_number_of_its_status(
    success: str, aborted: str, told: bool
) -> None:
    part = Part(ABORTED, {}, [GOAL, ASKED, result("aborted", NUMBERS), say(aborted), ENDED])
    assert (aborted_as_seen(evidence(success, part)) == "") is told


def test_a_late_echo_of_feedback_is_no_word_on_the_result() -> None:
    events = [
        GOAL,
        say("6 numbers so far"),
        ASKED,
        result("aborted", NUMBERS),
        say("6 numbers so far"),
        ENDED,
    ]
    assert aborted_as_seen(evidence("all done", Part(ABORTED, {}, events))) != ""


@pytest.mark.parametrize(("line", "error", "told"), cases(__file__, "a_refusal_is_told_by_its_word"))
def test_a_refusal_is_told_by_its_word(line: str, error: str, told: bool) -> None:
    events = [GOAL, say(line)]
    if error:
        events.append(Event(0.0, "subject", "raised", {"traceback": f"Traceback:\n{error}"}))
    assert (refused_as_seen(evidence("done", Part(REFUSED, {}, [*events, ENDED]))) == "") is told


def test_an_abort_may_be_seen_on_the_goal_s_status_topic() -> None:
    part = Part(ABORTED, {}, [GOAL, result("aborted", NUMBERS), say("aborted"), ENDED])
    assert aborted_as_seen(evidence("done", part)) == ""


def test_who_stays_after_a_refusal_and_not_after_a_success_never_ends() -> None:
    part = Part(REFUSED, {}, [GOAL, say("rejected")])
    assert refused_as_seen(evidence("done", part)) == "the rejection was reported, but the client did not end"


def test_feedback_counts_where_its_newest_number_is_said_after_it() -> None:
    early, shown, missed = feedback(1, 111), feedback(1, 111, 222), feedback(1, 111, 222, 333)
    part = Part(LATE, {}, [say("222"), early, say("[1, 111]"), shown, say("now 2_2_2"), missed, say("222")])
    assert unshown_feedback(part) == [missed]


def test_a_result_is_reported_by_all_its_numbers_after_it_came() -> None:
    head = [GOAL, ASKED, say(str(NUMBERS)), result("succeeded", NUMBERS)]
    assert not reports_result(Part(LATE, {}, head))
    assert not reports_result(Part(LATE, {}, [*head, say(str(NUMBERS[:2]))]))
    assert reports_result(Part(LATE, {}, [*head, say("array('i', [100001, 200002, 300003])")]))


def test_a_number_that_is_left_out_is_not_found_in_the_same_line_on_rosout() -> None:
    head = [GOAL, ASKED, result("succeeded", [300_003, 100_001, 300_003])]
    line = "[300003, 100001]"
    twice = [say(line), Event(0.0, "log", "client", {"text": line, "level": 20})]
    assert not reports_result(Part(LATE, {}, [*head, *twice]))


def test_a_result_is_reported_in_its_order() -> None:
    head = [GOAL, ASKED, result("succeeded", [300_003, 100_001, 300_003])]
    assert reports_result(Part(LATE, {}, [*head, say("300,003 then 100_001 - 300003")]))
    assert not reports_result(Part(LATE, {}, [*head, say("[300003, 100001]")]))
    assert not reports_result(Part(LATE, {}, [*head, say("[100001, 300003, 300003]")]))


@pytest.mark.parametrize(
    ("value", "right"),
    [
        *cases(__file__, "a_function_returns_the_numbers_in_any_kind_of_sequence"),
        (None, False),
    ],
)
def test_a_function_returns_the_numbers_in_any_kind_of_sequence(value: str | None, right: bool) -> None:
    part = Part(LATE, {}, [Event(0.0, "subject", "returned", {"value": value})])
    assert (returned_instead(part, [1, 2]) == "") is right


@pytest.mark.parametrize(("value", "right"), cases(__file__, "only_an_empty_sequence_is_an_empty_list"))
def test_only_an_empty_sequence_is_an_empty_list(value: str, right: bool) -> None:
    part = Part(LATE, {}, [Event(0.0, "subject", "returned", {"value": value})])
    assert (returned_instead(part, []) == "") is right


def test_a_program_returns_nothing() -> None:
    assert returned_instead(Part(LATE, {}, [ENDED]), [1, 2]) == ""


def test_a_cancel_counts_before_the_end_of_the_goal_and_before_the_program_is_stopped() -> None:
    cancel = Event(0.0, "cancel", "/fibonacci", {"accepted": True, "known": True})
    assert cancels_unasked(Part(LATE, {}, [GOAL, cancel]))
    assert not cancels_unasked(Part(LATE, {}, [GOAL, result("succeeded", NUMBERS), cancel]))
    assert not cancels_unasked(Part(LATE, {}, [GOAL, Event(0.0, "subject", INTERRUPTED), cancel]))
