"""The judge's own participant."""

from __future__ import annotations

import contextlib
import threading
from typing import Any

import pytest
from rcl_interfaces.srv import GetParameters
from std_msgs.msg import String

from autograder.judge import ros_setup
from autograder.judge.bench.judge_nodes import Wire

pytestmark = pytest.mark.ros


def test_what_is_taken_away_while_it_is_used_ends_nothing() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        is_gone, turned = threading.Event(), threading.Event()

        def answer(_: Any, send: Any) -> None:
            wire.node.destroy_service(service)
            is_gone.set()
            send(GetParameters.Response())

        service = wire.node.create_service(GetParameters, "asked", answer)
        client = wire.node.create_client(GetParameters, "asked")
        assert client.wait_for_service(timeout_sec=180)
        wire.executor.ask(client, GetParameters.Request(), print)
        assert is_gone.wait(180)
        wire.executor.do(turned.set)
        assert turned.wait(180)
        assert wire.failure is None


def test_an_error_of_a_callback_is_the_judges_failure() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:

        def fail(_: Any, __: Any) -> Any:
            raise ValueError("a bug")

        wire.node.create_service(GetParameters, "asked", fail)
        client = wire.node.create_client(GetParameters, "asked")
        assert client.wait_for_service(timeout_sec=180)
        wire.executor.ask(client, GetParameters.Request(), print)
        wire._thread.join(timeout=180)
        assert isinstance(wire.failure, ValueError)


def test_its_turns_wait_for_no_event_that_nobody_asked_for() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        wire.node.create_publisher(String, "spoken", 10)
        wire.node.create_subscription(String, "heard", lambda _: None, 10)
        assert list(wire.node.waitables) == []


MESSAGES = 5


def test_all_that_was_sent_is_taken_in_also_by_a_judge_that_was_busy_meanwhile() -> None:
    with (
        ros_setup.lease_domain() as domain_id,
        contextlib.closing(Wire(domain_id)) as theirs,
        contextlib.closing(Wire(domain_id)) as wire,
    ):
        heard: list[str] = []
        met, held, free = threading.Event(), threading.Event(), threading.Event()

        def hear(message: String) -> None:
            met.set()
            heard.append(message.data)

        def hold_up() -> None:
            held.set()
            free.wait(180)

        wire.node.create_subscription(String, "chatter", hear, 10)
        publisher = theirs.node.create_publisher(String, "chatter", 10)
        while not met.wait(0.05):
            publisher.publish(String(data="hello"))
        # Its executor is held up, and the messages wait.
        wire.executor.do(hold_up)
        assert held.wait(180)
        before = len(heard)
        for number in range(MESSAGES):
            publisher.publish(String(data=str(number)))
        taken: list[bool] = []
        taking = threading.Thread(target=lambda: taken.append(wire.take_in()), daemon=True)
        taking.start()
        assert len(heard) == before
        free.set()
        taking.join(180)
        assert taken == [True]
        assert heard[-MESSAGES:] == [str(number) for number in range(MESSAGES)]


def test_a_judge_that_has_failed_takes_nothing_in() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        wire.executor.do(lambda: 1 / 0)
        wire._thread.join(timeout=180)
        assert not wire.take_in()


def test_a_wire_that_was_closed_takes_nothing_in() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        pass
    assert not wire.take_in()


def test_a_service_whose_name_would_be_too_long_has_no_server() -> None:
    with ros_setup.lease_domain() as domain_id, contextlib.closing(Wire(domain_id)) as wire:
        name = f"/{'n' * 250}/get_parameters"
        client = wire.client(GetParameters, name)
        assert not client.service_is_ready()
        assert wire.count_servers(name) == 0
        assert not wire.node.destroy_client(client)
