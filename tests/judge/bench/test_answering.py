"""An answer is sent until it arrives: no ROS is started."""

from __future__ import annotations

import threading
import time
import warnings
from types import SimpleNamespace
from typing import Any

from autograder.judge.bench.recorded_services import ATTEMPTS, LateAnswers, patiently


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


def test_an_answer_is_held_back_as_long_as_it_is_told() -> None:
    told: list[str] = []
    done = threading.Event()
    held: Any = SimpleNamespace(send_response=lambda *_: done.set())
    LateAnswers(held, 0.3, sending=lambda _: told.append("sending"))
    began = time.monotonic()
    held.send_response(None, None)
    assert done.wait(180.0)
    assert time.monotonic() - began >= 0.3
    assert told[0] == "sending"


def test_the_next_request_is_not_kept_waiting_by_an_answer_that_is_held_back() -> None:
    sent: list[int] = []
    held = service(0, sent)
    late = LateAnswers(held, 3600.0, sending=lambda _: None)
    held.send_response(None, None)
    held.send_response(None, None)
    late.close()
    assert sent == []


def test_nothing_is_sent_by_a_service_that_is_taken_away() -> None:
    sent: list[int] = []
    held = service(0, sent)
    late = LateAnswers(held, 0.05, sending=lambda _: None)
    held.send_response(None, None)
    late.close()
    time.sleep(0.2)
    assert sent == []
