"""Shortened waits end where the usual ones end, only sooner: no ROS is started."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace
from typing import Any

import pytest
import rclpy.client
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.node import Node

from autograder.notebook.hurry import Hurry
from autograder.notebook.looking import ENOUGH, Looking
from autograder.notebook.overhearing import Overhearing


def client(*, ready: threading.Event) -> Any:
    context = SimpleNamespace(ok=lambda: True)
    return SimpleNamespace(
        context=context,
        service_is_ready=ready.is_set,
        _node=SimpleNamespace(context=context),
        server_is_ready=ready.is_set,
    )


@pytest.mark.parametrize("wait", [lambda: Client.wait_for_service, lambda: ActionClient.wait_for_server])
def test_a_wait_ends_when_the_server_is_there(wait: Any) -> None:
    ready = threading.Event()
    with Hurry(lambda: True):
        assert wait()(client(ready=ready), timeout_sec=0.01) is False
        assert wait()(client(ready=ready), timeout_sec=0.0) is False
        threading.Timer(0.01, ready.set).start()
        assert wait()(client(ready=ready)) is True


def test_everything_is_put_back() -> None:
    before = (
        time.sleep,
        Client.wait_for_service,
        ActionClient.wait_for_server,
        Node.get_service_names_and_types,
    )
    with Hurry(lambda: True), Looking(lambda: None, lambda: True):
        assert time.sleep is not before[0]
    after = (
        time.sleep,
        Client.wait_for_service,
        ActionClient.wait_for_server,
        Node.get_service_names_and_types,
    )
    assert after == before


def test_only_the_subjects_sleeps_are_shortened_and_only_on_demand(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    subject = True
    with Hurry(lambda: subject) as hurry:
        time.sleep(0.5)
        hurry.factor = 0.1
        time.sleep(0.5)
        time.sleep(0.001)
        subject = False
        time.sleep(0.5)
    assert slept == pytest.approx([0.5, 0.05, 0.001, 0.5])


def test_a_hung_wait_looks_like_rclpys_own() -> None:
    ready = threading.Event()
    with Overhearing(lambda _: None) as hearing, Hurry(hearing.overhears):
        thread = threading.Thread(target=lambda: Client.wait_for_service(client(ready=ready)), daemon=True)
        thread.start()
        while "wait_for_service" not in (stacks := hearing.stacks()):
            time.sleep(0.001)
        ready.set()
        thread.join()
    assert f'File "{rclpy.client.__file__}"' in stacks
    assert "notebook/hurry.py" not in stacks.replace(__file__, "")


def test_looks_at_the_graph_are_told_up_to_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Node, "get_service_names_and_types", lambda _: ["the answer"])
    told: list[int] = []
    subject = True
    with Looking(lambda: told.append(1), lambda: subject) as looking:
        for _ in range(ENOUGH + 5):
            assert Node.get_service_names_and_types(None) == ["the answer"]  # type: ignore[arg-type, comparison-overlap]
        assert len(told) == ENOUGH
        looking.begin_run()
        subject = False
        Node.get_service_names_and_types(None)  # type: ignore[arg-type]
        assert len(told) == ENOUGH
