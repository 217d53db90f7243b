"""The executor of the judge's node: what it takes in a round, and in which order."""

from __future__ import annotations

import contextlib
import threading
from typing import Any

import pytest
from std_msgs.msg import String
from std_srvs.srv import Trigger

from autograder.judge import ros_setup
from autograder.judge.bench.batch_executor import LONG_QUEUE
from autograder.judge.bench.judge_nodes import Wire

pytestmark = pytest.mark.ros


def test_one_round_takes_all_that_has_arrived_a_message_of_each_endpoint_in_turn() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        heard: list[str] = []

        def hear(message: String) -> None:
            heard.append(message.data)

        def hold_up() -> None:
            held.set()
            free.wait(180)

        held, free = threading.Event(), threading.Event()
        publishers = [wire.node.create_publisher(String, topic, 10) for topic in ("left", "right")]
        for topic in ("left", "right"):
            wire.node.create_subscription(String, topic, hear, 10)
        while any(publisher.get_subscription_count() == 0 for publisher in publishers):
            wire.take_in()
        wire.executor.do(hold_up)
        assert held.wait(180)
        for number in range(3):
            for publisher in publishers:
                publisher.publish(String(data=f"{publisher.topic_name} {number}"))
        wire.executor.do(lambda: heard.append("a task"))
        free.set()
        assert wire.take_in()
        assert heard == [f"/{topic} {n}" for n in range(3) for topic in ("left", "right")] + ["a task"]


def test_a_flood_is_not_taken_in_for_ever() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        heard = 0
        publisher = wire.node.create_publisher(String, "flood", 10)

        def send_the_next(message: String) -> None:
            nonlocal heard
            heard += 1
            publisher.publish(message)

        wire.node.create_subscription(String, "flood", send_the_next, 10)
        while publisher.get_subscription_count() == 0:
            wire.take_in()
        publisher.publish(String(data="again"))
        assert wire.take_in()
        assert wire.take_in()
        assert heard >= LONG_QUEUE


@pytest.mark.parametrize("servers", [1, 2])
def test_the_first_answer_of_servers_with_one_name_is_the_answer(servers: int) -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:

        def answer(_: Any, send: Any) -> None:
            send(Trigger.Response(message="hello"))

        for _ in range(servers):
            wire.node.create_service(Trigger, "asked", answer)
        client = wire.node.create_client(Trigger, "asked")
        assert client.wait_for_service(timeout_sec=180)
        told: list[str] = []
        answered = threading.Event()

        def take(response: Trigger.Response) -> None:
            told.append(response.message)
            answered.set()

        wire.executor.ask(client, Trigger.Request(), take)
        assert answered.wait(180)
        assert wire.take_in()
        assert told == ["hello"]
        assert wire.failure is None
