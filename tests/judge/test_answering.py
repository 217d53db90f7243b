"""An answer is sent until it arrives: no ROS is started."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

from autograder.judge.answering import ATTEMPTS, patiently


def service(lost: int, sent: list[int]) -> Any:
    def send_response(response: Any, header: Any) -> None:
        sent.append(1)
        if len(sent) <= lost:
            warnings.warn("failed to send response (timeout)", RuntimeWarning, stacklevel=2)

    return SimpleNamespace(send_response=send_response)


def test_a_lost_answer_is_sent_again() -> None:
    sent: list[int] = []
    patiently(service(3, sent))(None, None)
    assert len(sent) == 4


def test_nobody_there_is_not_waited_for_without_end() -> None:
    sent: list[int] = []
    patiently(service(10**6, sent))(None, None)
    assert len(sent) == ATTEMPTS
