"""The rule for an outcome: its word, in a line that no run says that ended otherwise. No ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.outcomes import Outcome, shape
from tests.cases import cases

CANCELED = Outcome("canceled", "cancelled")
REJECTED = Outcome("rejected")
FRAME = 'Traceback (most recent call last):\n  File "/home/student/client.py", line 9, in main\n    '


def run(*lines: str, returned: str | None = None, traceback: str = "") -> Part:
    events = [Event(0.0, "output", "stdout", {"text": line}) for line in lines]
    if returned is not None:
        events.append(Event(0.1, "subject", "returned", {"value": returned}))
    if traceback:
        events.append(Event(0.1, "subject", "raised", {"traceback": FRAME + traceback}))
    return Part("", {}, events)


@pytest.mark.parametrize(
    ("canceled", "otherwise", "reported"),
    cases(__file__, "an_outcome_is_reported_by_its_word_in_a_line_of_its_own"),
)
def test_an_outcome_is_reported_by_its_word_in_a_line_of_its_own(
    canceled: str, otherwise: str, reported: bool
) -> None:
    assert (CANCELED.missing(run(canceled), [run(otherwise)]) == "") is reported


def test_what_is_returned_or_raised_on_purpose_is_said() -> None:
    assert REJECTED.reported(run(returned="'rejected'"), []) == "'rejected'"
    assert REJECTED.reported(run(traceback="raise RuntimeError(text)\nRuntimeError: rejected"), [])
    assert not REJECTED.reported(run(traceback="print(names[text])\nKeyError: 'rejected'"), [])


def test_each_line_of_an_exception_is_said_whether_of_its_message_or_of_its_notes() -> None:
    raised = (
        'Traceback (most recent call last):\n  File "a.py", line 4, in run\n    raise RuntimeError(text)\n'
    )
    assert REJECTED.reported(run(traceback=f"{raised}RuntimeError: rejected\nIs it too large?"), [])
    assert REJECTED.reported(run(traceback=f"{raised}RuntimeError: sorry\n\nIt was rejected.\nWhy?\n"), [])
    slip = raised.replace("raise RuntimeError(text)", "names[text]")
    assert not REJECTED.reported(run(traceback=f"{slip}KeyError: 'rejected'\nlook at the names"), [])


@pytest.mark.parametrize("value", ["None", "[]", "0", "''"])
def test_a_value_without_the_word_says_nothing(value: str) -> None:
    assert REJECTED.missing(run(returned=value), []) == "it was not reported"


def test_the_diagnosis_quotes_what_was_said_and_the_word() -> None:
    usual = run("hello", "done")
    advice = REJECTED.advice(run("hello", "denied"), [usual], "The goal was rejected", "Say so.")
    assert advice.text == (
        "The goal was rejected, and your program said “denied”; the task asks for a line with the word `rejected`."
    )
    silent = REJECTED.advice(run(), [usual], "The goal was rejected", "Say so.")
    assert "did not report this; the task asks" in silent.text
    always = REJECTED.advice(run("rejected?"), [run("rejected?")], "The goal was rejected", "Say so.")
    assert "in runs with another outcome" in always.text


def test_a_number_behind_the_word_status_is_its_name() -> None:
    assert shape("Status of the goal: 6 [1, 2]") == "status of the goal: aborted"
    assert shape("6 numbers, status unknown") == "numbers status unknown"


@pytest.mark.parametrize(
    "line", cases(__file__, "the_number_of_a_status_may_have_other_words_and_numbers_around_it")
)
def test_the_number_of_a_status_may_have_other_words_and_numbers_around_it(line: str) -> None:
    assert CANCELED.is_said_in(line)


@pytest.mark.parametrize(
    "line", ["NOT  available", "is not\tavailable", "not\u00a0Available", "not\navailable"]
)
def test_spaces_of_any_kind_are_spaces(line: str) -> None:
    assert Outcome("not available").is_said_in(line)


@pytest.mark.parametrize("line", ["5 is the status", "status 15", "status ok, 15 numbers: 7", "result: 5"])
def test_another_number_is_no_status(line: str) -> None:
    assert not CANCELED.is_said_in(line)
