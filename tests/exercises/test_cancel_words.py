"""What counts as saying how a canceled goal ended, and what is false of one of the two goals: no ROS is started."""

from __future__ import annotations

import pytest
from exercise_1_3._cancel_words import false_claim, says_canceled

from autograder.kit.evidence import Event, Part


def run(*lines: str) -> Part:
    said = [Event(0.0, "output", "stdout", {"text": line}) for line in lines]
    result = Event(0.0, "result", "/fibonacci", {"status": "", "fields": {"sequence": [0, 1]}})
    return Part("", {}, [Event(0.0, "result_request", "/fibonacci", {"known": True}), result, *said])


def right(canceled: str, succeeded: str) -> bool:
    one, other = run(canceled), run(*filter(None, [succeeded]))
    told = says_canceled(one.said(), other.said(), other)
    return told and false_claim(one, other) is None


@pytest.mark.parametrize(
    ("canceled", "succeeded"),
    [
        ("status=5 canceled=True", "status=4 canceled=False"),
        ("5 0 1 1 2 3 5", "4 0 1 1 2 3 5 8"),
        ("0, 1, 1, 2, 3: 5", "0, 1, 1, 2, 3, 5: 4"),
        ("Final status: 5", "Final status: 4"),
        ("Goal was successfully canceled.", "Goal succeeded! Result: [0, 1]"),
        ("canceled, with 5 numbers", "NOT canceled: the goal ended with status 4"),
        ("the goal ended as CANCELED", "the goal ended as SUCCEEDED"),
        ("Endzustand: CANCELED", "Endzustand: SUCCEEDED"),
        ("das Ziel wurde abgebrochen", "das Ziel wurde nicht abgebrochen"),
        ("goals canceled: 1, status 5", "goals canceled: 0, status 4"),
        ("cancel succeeded, status 5", "cancel refused, status 4"),
        ("after the cancel request: status 5", "after the cancel request: status 4"),
        ("status 5, canceled after 3 feedbacks", "status 4, canceled after 3 feedbacks"),
        ("goal was canceled", "expected canceled, got 4"),
        ("the goal was canceled", "the goal could not be canceled, it succeeded"),
        ("canceled: yes, succeeded: no", "canceled: no, succeeded: yes"),
        ("goal canceled", ""),
        ("5 = CANCELED, not SUCCEEDED", "4 = SUCCEEDED, not CANCELED"),
        ("was it canceled? yes", "was it canceled? no"),
        ("is_canceled=True", "is_canceled=False"),
        ("Goal canceled: True (5)", "Goal canceled: False (4)"),
        ("goal canceled as asked: True", "goal canceled as asked: False"),
        ("goal canceled successfully: True", "goal canceled successfully: False"),
        ("CANCELED; succeeded anyway: no", "SUCCEEDED; succeeded anyway: yes"),
        ("cancel success: True (5)", "cancel success: False (4)"),
        ("asked for it to be canceled: yes. Ended: 5", "asked for it to be canceled: yes. Ended: 4"),
        ("[CANCELED] after 14", "[SUCCEEDED] after 14"),
        ("status [5]", "status [4]"),
        ("ended (5) [0, 1]", "ended (4) [0, 1]"),
        ("Status: [ ] 4 SUCCEEDED [x] 5 CANCELED", "Status: [x] 4 SUCCEEDED [ ] 5 CANCELED"),
        ("not canceled: False, 5", "not canceled: True, 4"),
        ("The goal was CANCELED.", "The goal was completed: the cancel request came too late."),
        ("canceled", "completed (cancel ignored)"),
        ("canceled", "finished before the cancel arrived"),
        ("canceled", "was never canceled, it ran to its end"),
        ("canceled", "ended without being canceled"),
        ("canceled", "cancel requested after 3 messages, finished normally"),
        ("Canceled, status 5", "Not canceled, status 4"),
        ("canceled after 3 messages: 5", "canceled after 3 messages: 4"),
        ("L'objectif a été annulé (CANCELED)", "L'objectif n'a pas été annulé"),
        ("Het doel is geannuleerd (CANCELED)", "Het doel is niet geannuleerd"),
        ("terminó como CANCELED", "no terminó como CANCELED"),
        ("是 CANCELED", "不是 CANCELED"),
        ("Final status: CANCELED", "Final status: other than CANCELED"),
        ("Final status == CANCELED", "Final status != CANCELED"),
        ("the goal ended canceled", "the goal ended uncanceled"),
        ("it was canceled", "completed rather than canceled"),
    ],
)
def test_who_says_how_each_goal_ended_is_right(canceled: str, succeeded: str) -> None:
    assert right(canceled, succeeded)


@pytest.mark.parametrize(
    ("canceled", "succeeded"),
    [
        ("result: 0 1 1 2 3 5 8 13", "result: 0 1 1 2 3"),
        ("0, 1, 1, 2, 3, 5", "0, 1, 1, 2, 3, 5, 8"),
        ("status=5 canceled=True", "status=4 canceled=True"),
        ("status=5 canceled=False", "status=4 canceled=True"),
        ("status=5 canceled=False", "status=4 canceled=False"),
        ("status=5 succeeded=True", "status=4 succeeded=True"),
        ("status=5 succeeded=True", "status=4 succeeded=False"),
        ("status 5: CANCELED", "status 4: CANCELED"),
        ("status 5: SUCCEEDED", "status 4: SUCCEEDED"),
        ("the goal was canceled (5)", "the goal was canceled (4)"),
        ("the goal succeeded (5)", "the goal succeeded (4)"),
        ("canceled: yes, status 5", "canceled: yes, status 4"),
        ("goal canceled", "goal canceled"),
        ("the goal ended as SUCCEEDED", "the goal ended as CANCELED"),
        ("done", "done"),
        ("goal canceled as asked: True (5)", "goal canceled as asked: True (4)"),
        ("[5, 1] done", "[4, 1] done"),
        ("Canceled, status 5", "Canceled, status 4"),
        ("=> CANCELED (5)", "=> CANCELED (4)"),
        ("Result: canceled (5)", "Result: canceled (4)"),
        ("Succeeded (5)", "Succeeded (4)"),
        ("ticket qwer says canceled", "ticket asdf says canceled"),
    ],
)
def test_a_word_that_is_true_of_the_other_goal_only_is_wrong(canceled: str, succeeded: str) -> None:
    assert not right(canceled, succeeded)


@pytest.mark.parametrize(
    ("canceled", "aborted", "tells"),
    [
        ("Cancel accepted by the server", "Cancel accepted by the server", False),
        ("Cancel successful", "Cancel successful", False),
        ("Objetivo cancelado", "Objetivo cancelado", False),
        ("Cancel accepted, status 5", "Cancel accepted, status 6", True),
        ("das Ziel wurde abgebrochen", "das Ziel wurde abgebrochen", True),
        ("the cancellation worked", "the cancellation did not work", True),
    ],
)
def test_the_answer_to_the_request_is_no_status(canceled: str, aborted: str, tells: bool) -> None:
    assert says_canceled([canceled], ["status 4"], run("status 4"), run(aborted)) is tells


@pytest.mark.parametrize(
    ("words", "ended"),
    [
        ("the goal ended as CANCELED", "succeeded in spite of the cancel request"),
        ("the goal ended as SUCCEEDED", "was canceled"),
    ],
)
def test_who_says_the_same_of_both_goals_hears_of_the_one_for_which_it_is_false(
    words: str, ended: str
) -> None:
    assert false_claim(run(words), run(words)) == (words, ended)


@pytest.mark.parametrize(
    ("words", "false"),
    [
        ("Final status: CANCELED", True),
        ("Final status: SUCCEEDED", True),
        ("CANCELED", True),
        ("canceled: True", True),
        ("Final status: ABORTED", False),
        ("status 6, canceled: False", False),
        ("it could not be canceled, it succeeded", False),
        ("The goal ended otherwise: it neither succeeded nor was canceled.", False),
        ("Canceled, status 6", True),
        ("das Ziel wurde abgebrochen", False),
    ],
)
def test_that_the_server_has_agreed_to_cancel_does_not_say_how_the_goal_ended(
    words: str, false: bool
) -> None:
    claim = false_claim(run("status 5"), run("status 4"), run(words))
    assert (claim is not None) is false
