"""The judge's own participant."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from rcl_interfaces.srv import GetParameters

from autograder.judge.bench.wire import Wire
from autograder.judge.serving import domain

pytestmark = pytest.mark.ros


def test_what_is_taken_away_while_it_is_used_ends_nothing() -> None:
    with domain.lease() as domain_id, Wire(domain_id) as wire:

        def answer(_: Any, response: Any) -> Any:
            wire.node.destroy_service(service)
            return response

        service = wire.node.create_service(GetParameters, "asked", answer)
        client = wire.node.create_client(GetParameters, "asked")
        assert client.wait_for_service(timeout_sec=180)
        client.call_async(GetParameters.Request())
        turned = threading.Event()
        wire.node.create_timer(0.3, turned.set)
        assert turned.wait(10.0)
        assert wire.failure is None


def test_an_error_of_a_callback_is_the_judges_failure() -> None:
    with domain.lease() as domain_id, Wire(domain_id) as wire:
        raised = threading.Event()

        def fail() -> None:
            raised.set()
            raise ValueError("a bug")

        wire.node.create_timer(0.01, fail)
        assert raised.wait(10.0)
        wire._thread.join(timeout=180)
        assert isinstance(wire.failure, ValueError)
