"""What counts as saying that a goal was refused or aborted, in any language: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.goal_reports import (
    ABORTED,
    LATE,
    REFUSED,
    aborted_as_seen,
    refused_as_seen,
    reports_result,
    unshown_feedback,
)

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


@pytest.mark.parametrize(
    ("success", "aborted", "told"),
    [
        ("Result: [1, 2, 3]", "Result: [1, 2, 3]", False),
        ("succeeded: [1, 2, 3]", "aborted", True),
        ("status 4, [1, 2, 3]", "status 6, [1, 2, 3]", True),
        ("Fertig: [1, 2, 3]", "Daraus wurde nichts.", True),
        ("succeeded: [1, 2, 3]", "the goal was canceled", False),
        ("succeeded: [1, 2, 3]", "succeeded!", False),
    ],
)
def test_an_abort_is_told_by_name_by_number_or_by_other_words(success: str, aborted: str, told: bool) -> None:
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


@pytest.mark.parametrize(
    ("line", "error", "told"),
    [
        ("rejected :(", "", True),
        ("refusé", "", True),
        ("goal sent", "", False),
        ("goal sent", "RuntimeError: not accepted", True),
        ("goal sent", "AttributeError: 'NoneType' object has no attribute 'status'", False),
    ],
)
def test_a_refusal_is_told_by_words_that_a_success_does_not_have(line: str, error: str, told: bool) -> None:
    events = [GOAL, say(line)]
    if error:
        events.append(Event(0.0, "subject", "raised", {"traceback": f"Traceback:\n{error}"}))
    assert (refused_as_seen(evidence("done", Part(REFUSED, {}, [*events, ENDED]))) == "") is told


@pytest.mark.parametrize(
    ("line", "told"),
    [("the server did not take it", True), ("status 0", False), ("ended as UNKNOWN", False), ("done", False)],
)
def test_rclpy_s_blocking_call_asks_by_itself_and_its_caller_tells_of_the_refusal(
    line: str, told: bool
) -> None:
    refused = Part(REFUSED, {}, [GOAL, ASKED, say(line), ENDED])
    told_of_abort = Part(ABORTED, {}, [GOAL, ASKED, result("aborted", NUMBERS), say("status 6"), ENDED])
    wrong = refused_as_seen(evidence("done", refused, told_of_abort))
    assert (wrong == "") if told else ("asked for the result" in wrong)


def test_an_abort_may_be_seen_on_the_goal_s_status_topic() -> None:
    part = Part(ABORTED, {}, [GOAL, result("aborted", NUMBERS), say("aborted"), ENDED])
    assert aborted_as_seen(evidence("done", part)) == ""


def test_who_stays_after_a_refusal_and_not_after_a_success_never_ends() -> None:
    part = Part(REFUSED, {}, [GOAL, say("rejected")])
    assert refused_as_seen(evidence("done", part)) == "said so, and did not end"


def test_feedback_counts_where_its_newest_number_is_said_after_it() -> None:
    early, shown, missed = feedback(1, 111), feedback(1, 111, 222), feedback(1, 111, 222, 333)
    part = Part(LATE, {}, [say("222"), early, say("[1, 111]"), shown, say("now 2_2_2"), missed, say("222")])
    assert unshown_feedback(part) == [missed]


def test_a_result_is_reported_by_all_its_numbers_after_it_came() -> None:
    head = [GOAL, ASKED, say(str(NUMBERS)), result("succeeded", NUMBERS)]
    assert not reports_result(Part(LATE, {}, head))
    assert not reports_result(Part(LATE, {}, [*head, say(str(NUMBERS[:2]))]))
    assert reports_result(Part(LATE, {}, [*head, say("array('i', [100001, 200002, 300003])")]))
