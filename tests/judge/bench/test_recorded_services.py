"""What the judge serves is recorded from the first request on, and sent until it arrives: no ROS is started."""

from __future__ import annotations

import threading
import time
import warnings
from types import SimpleNamespace
from typing import Any

from builtin_interfaces.msg import Time

from autograder.judge.bench.recorded_actions import ScriptedActionServer
from autograder.judge.bench.recorded_services import ATTEMPTS, LateAnswers, RecordedServer, patiently
from autograder.judge.bench.recorder import Recorder


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


LONG_ENOUGH = 0.2
"""Seconds in which a request would be answered that is not kept waiting."""


class EagerNode:
    """A node whose services are asked in the moment of their creation, before their maker has them."""

    def __init__(self) -> None:
        self.asked: list[threading.Thread] = []

    def create_service(self, kind: Any, name: str, callback: Any) -> Any:
        service = SimpleNamespace(send_response=lambda *_: None)

        def ask() -> None:
            response = callback(kind.Request(), kind.Response())
            service.send_response(response, None)

        thread = threading.Thread(target=ask, daemon=True)
        self.asked.append(thread)
        thread.start()
        thread.join(LONG_ENOUGH)
        return service

    def create_publisher(self, *_: Any) -> Any:
        return SimpleNamespace(publish=lambda _: None, get_subscription_count=lambda: 1)

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=Time))

    def answered(self) -> bool:
        for thread in self.asked:
            thread.join(180.0)
        return not any(thread.is_alive() for thread in self.asked)


def test_who_asks_a_service_while_it_is_made_is_answered_on_record() -> None:
    node, recorder = EagerNode(), Recorder()
    wire: Any = SimpleNamespace(node=node)
    RecordedServer(wire, recorder, "/light", "std_srvs/srv/SetBool", lambda _: {})
    assert node.answered()
    assert [event.kind for event in recorder.part().events] == ["request", "response"]


def test_who_asks_an_action_while_it_is_made_is_answered_on_record() -> None:
    node, recorder = EagerNode(), Recorder()
    wire: Any = SimpleNamespace(node=node)
    ScriptedActionServer(
        wire,
        recorder,
        "/fibonacci",
        "my_robot_interfaces/action/Fibonacci",
        accept_goal=False,
        accept_cancel=False,
        goal_answer_takes=0.0,
        cancel_answer_takes=0.0,
        client_is_gone=lambda: False,
    )
    assert node.answered()
    kinds = [event.kind for event in recorder.part().events]
    assert {"goal_answered", "cancel_answered"} <= set(kinds)
