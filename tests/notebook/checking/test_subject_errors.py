"""An exception in a callback of a subject: it ends the subject only if it would end rclpy.spin in a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from rclpy.action import ActionServer

from autograder.messages.judge_messages import Raised
from autograder.messages.run_messages import Output
from autograder.notebook.checking.subject_runs import UNREADABLE, SubjectRun
from autograder.notebook.nodes.spin_threads import SpinFailure

if TYPE_CHECKING:
    from autograder.messages.json_lines import Message


def _told(error: BaseException, entity: object) -> list[Message]:
    told: list[Message] = []
    context: Any = None
    SubjectRun(1, _told, context, told.append)._callback_raised(SpinFailure(error, entity))
    return told


def _raised_by_a_student() -> ValueError:
    with pytest.raises(ValueError, match="oops") as raised:
        raise ValueError("oops")
    return raised.value


SERVER = object.__new__(ActionServer)


def test_an_exception_of_an_execute_callback_is_printed_as_rclpy_does_and_ends_nothing() -> None:
    told = _told(_raised_by_a_student(), SERVER)
    assert all(isinstance(message, Output) for message in told)
    texts = [message.text for message in told if isinstance(message, Output)]
    assert texts[0].startswith("Traceback")
    assert texts[-1] == "ValueError: oops"


def test_an_exception_of_any_other_callback_ends_the_subject() -> None:
    (told,) = _told(_raised_by_a_student(), object())
    assert isinstance(told, Raised)


def test_a_missing_result_ends_the_subject_as_it_ends_rclpy_spin() -> None:
    (told,) = _told(TypeError("the execute callback must return a result of the action"), SERVER)
    assert isinstance(told, Raised)


def test_an_error_that_ends_whoever_reads_it_is_told_with_its_line() -> None:
    class Unreadable(Exception):
        def __getattribute__(self, name: str) -> Any:
            raise KeyboardInterrupt(name)

    try:
        raise Unreadable
    except Unreadable as error:
        (told,) = _told(error, object())
    assert isinstance(told, Raised)
    assert told.traceback.endswith(UNREADABLE)
    assert "raise Unreadable" in told.traceback
