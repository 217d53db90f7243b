"""The judge is told of the subject's looks and calls, and of nobody else's: no ROS is started."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.node import Node

from autograder.messages.judge_messages import Called, Looked
from autograder.notebook.checking.subject_reports import LOOKS_TOLD, TOLD, ToldCalls


@pytest.fixture
def answering(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every method that is told of answers with its name."""
    for owner, name, _ in TOLD:
        monkeypatch.setattr(owner, name, lambda *_, name=name, **__: name)


@pytest.mark.usefixtures("answering")
def test_each_look_and_each_call_is_told_and_answered_as_before() -> None:
    told: list[type] = []
    nobody: Any = None
    with ToldCalls(lambda: True, told.append):
        assert Node.get_service_names_and_types(nobody) == "get_service_names_and_types"  # type: ignore[comparison-overlap]
        assert Client.service_is_ready(nobody) == "service_is_ready"  # type: ignore[comparison-overlap]
        assert Client.call_async(nobody, None) == "call_async"  # type: ignore[comparison-overlap]
        assert ActionClient.send_goal_async(nobody, None) == "send_goal_async"
    assert told == [Looked, Looked, Called, Called]


@pytest.mark.usefixtures("answering")
def test_looks_are_told_up_to_a_number_in_each_run_and_calls_without_end() -> None:
    told: list[type] = []
    nobody: Any = None
    with ToldCalls(lambda: True, told.append) as calls:
        for _ in range(2):
            calls.begin_run()
            for _ in range(LOOKS_TOLD + 5):
                Client.service_is_ready(nobody)
                Client.call_async(nobody, None)
    assert told.count(Looked) == 2 * LOOKS_TOLD
    assert told.count(Called) == 2 * (LOOKS_TOLD + 5)


@pytest.mark.usefixtures("answering")
def test_another_thread_of_the_notebook_is_not_told_of() -> None:
    nobody: Any = None
    with ToldCalls(lambda: False, pytest.fail):
        Client.call_async(nobody, None)


def test_everything_is_put_back() -> None:
    before = [getattr(owner, name) for owner, name, _ in TOLD]
    with ToldCalls(lambda: True, lambda _: None):
        assert [getattr(owner, name) for owner, name, _ in TOLD] != before
    assert [getattr(owner, name) for owner, name, _ in TOLD] == before
