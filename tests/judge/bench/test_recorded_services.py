"""What the judge serves is recorded from the first request on, and sent until it arrives: no ROS is started."""

from __future__ import annotations

import threading
import time
import warnings
from types import SimpleNamespace
from typing import Any

from builtin_interfaces.msg import Time

from autograder.judge.bench.batch_executor import ATTEMPTS, send_until_received
from autograder.judge.bench.recorded_actions import ScriptedActionServer
from autograder.judge.bench.recorded_services import RecordedServer
from autograder.judge.bench.recorder import Place, Recorder


def service(lost: int, sent: list[int]) -> Any:
    def send_response(response: Any, header: Any) -> None:
        sent.append(1)
        if len(sent) <= lost:
            warnings.warn("failed to send response (timeout)", RuntimeWarning, stacklevel=2)

    return SimpleNamespace(send_response=send_response)


def test_a_lost_answer_is_sent_again() -> None:
    sent: list[int] = []
    send_until_received(service(3, sent), None, None)
    assert len(sent) == 4


def test_nobody_there_is_not_waited_for_without_end() -> None:
    sent: list[int] = []
    send_until_received(service(10**6, sent), None, None)
    assert len(sent) == ATTEMPTS


class EagerNode:
    """A node whose services are asked in the moment of their creation, before their maker has them."""

    def __init__(self) -> None:
        self.answers: list[Any] = []
        self.was_answered = threading.Event()
        self.ask: dict[str, Any] = {}

    def create_service(self, kind: Any, name: str, callback: Any) -> Any:
        def send(response: Any) -> None:
            self.answers.append(response)
            self.was_answered.set()

        def ask() -> None:
            callback(kind.Request(), send)

        self.ask[name.rpartition("/")[2]] = ask
        ask()

    def create_publisher(self, *_: Any) -> Any:
        return SimpleNamespace(publish=lambda _: None, get_subscription_count=lambda: 1)

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=Time))

    def destroy_service(self, _: Any) -> None: ...

    destroy_publisher = destroy_service


def place(node: EagerNode, name: str, type_name: str) -> Place:
    wire: Any = SimpleNamespace(node=node)
    return Place(wire, Recorder(), name, type_name, name)


def kinds(place: Place) -> list[str]:
    return [event.kind for event in place.recorder.part().events]


def action_server(at: Place, takes: float) -> ScriptedActionServer:
    return ScriptedActionServer(
        at, lambda: False, accept_goal=False, accept_cancel=False, goal_answer_takes=takes
    )


FIBONACCI = "my_robot_interfaces/action/Fibonacci"


def test_who_asks_a_service_while_it_is_made_is_answered_on_record() -> None:
    node = EagerNode()
    light = place(node, "/light", "std_srvs/srv/SetBool")
    RecordedServer(light, lambda _: {})
    assert len(node.answers) == 1
    assert kinds(light) == ["request", "response"]


def test_an_answer_may_be_held_back_or_late_or_never_come() -> None:
    node = EagerNode()
    light = place(node, "/light", "std_srvs/srv/SetBool")
    server = RecordedServer(light, lambda _: {}, hold=1, late={2: 0.0}, never={3})
    node.ask["light"]()
    node.ask["light"]()
    assert node.answers == []
    server.answer_due()
    assert len(node.answers) == 1
    server.release()
    assert len(node.answers) == 2
    node.ask["light"]()
    assert len(node.answers) == 3


def test_who_asks_an_action_while_it_is_made_is_answered_on_record() -> None:
    node = EagerNode()
    fibonacci = place(node, "/fibonacci", FIBONACCI)
    action_server(fibonacci, 0.0)
    assert len(node.answers) == 3
    assert {"goal_answered", "cancel_answered"} <= set(kinds(fibonacci))


def test_an_answer_is_held_back_as_long_as_it_is_told_and_then_on_record() -> None:
    node = EagerNode()
    fibonacci = place(node, "/fibonacci", FIBONACCI)
    began = time.monotonic()
    action_server(fibonacci, 0.3)
    node.was_answered.clear()
    assert "goal_answered" not in kinds(fibonacci)
    assert node.was_answered.wait(180.0)
    assert time.monotonic() - began >= 0.3
    assert kinds(fibonacci)[-1] == "goal_answered"


def test_the_next_request_is_not_kept_waiting_by_an_answer_that_is_held_back() -> None:
    node = EagerNode()
    fibonacci = place(node, "/fibonacci", FIBONACCI)
    server = action_server(fibonacci, 3600.0)
    node.ask["send_goal"]()
    assert kinds(fibonacci).count("goal") == 2
    server.close()
    assert "goal_answered" not in kinds(fibonacci)


def test_nothing_is_sent_by_a_service_that_is_taken_away() -> None:
    node = EagerNode()
    fibonacci = place(node, "/fibonacci", FIBONACCI)
    server = action_server(fibonacci, 0.05)
    server.close()
    time.sleep(0.2)
    assert "goal_answered" not in kinds(fibonacci)
