"""Shortened waits end where the usual ones end, only sooner: no ROS is started."""

from __future__ import annotations

import asyncio
import datetime
import sys
import threading
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
import rclpy.client
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.node import Node

from autograder.notebook.checking.captured_output import CapturedOutput
from autograder.notebook.checking.shorter_waits import LOOKS_TOLD, GraphQuestions, ShorterWaits

if TYPE_CHECKING:
    from collections.abc import Callable


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
    with ShorterWaits(lambda: True):
        assert wait()(client(ready=ready), timeout_sec=0.01) is False
        assert wait()(client(ready=ready), timeout_sec=0.0) is False
        threading.Timer(0.01, ready.set).start()
        assert wait()(client(ready=ready)) is True


def test_of_waits_for_a_server_that_will_not_come_some_seconds_are_left_out_and_told() -> None:
    told: list[float] = []
    nobody = client(ready=threading.Event())
    clock = time.monotonic  # not as a subject's look at a clock
    with ShorterWaits(lambda: True, lambda _, seconds: told.append(seconds)) as waits:
        waits.begin_run(spare=3000.0)
        # Nobody waits so long: a test that ends has left them out.
        assert not Client.wait_for_service(nobody, 1000.0)
        assert not ActionClient.wait_for_server(nobody, 1500.0)
        assert not Client.wait_for_service(nobody, -5.0)
        # What is left of it is waited.
        began = clock()
        assert not Client.wait_for_service(nobody, 500.3)
        assert clock() - began >= 0.25
    assert told == [1000.0, 1500.0, 500.0]


def test_who_begins_to_wait_without_a_limit_notices_the_server_all_the_same() -> None:
    ready = threading.Event()
    told: list[float] = []

    def tell(_: str, seconds: float) -> None:
        told.append(seconds)
        ready.set()

    with ShorterWaits(lambda: True, tell) as waits:
        waits.begin_run(spare=1.5)
        assert Client.wait_for_service(client(ready=ready))
    assert told == [1.5]


def test_who_looks_at_a_clock_waits_in_full() -> None:
    told: list[float] = []
    nobody = client(ready=threading.Event())
    with ShorterWaits(lambda: True, lambda _, seconds: told.append(seconds)) as waits:
        waits.begin_run(spare=12.0)
        end = time.monotonic() + 0.15
        while not Client.wait_for_service(nobody, 0.1) and time.monotonic() < end:
            pass
        assert time.monotonic() >= end
    assert told == []


def test_so_does_who_has_taken_the_clock_out_of_its_module(monkeypatch: pytest.MonkeyPatch) -> None:
    notebook: Any = sys.modules["__main__"]
    monkeypatch.setattr(notebook, "now", time.monotonic, raising=False)
    with ShorterWaits(lambda: True) as waits:
        waits.begin_run(spare=12.0)
        notebook.now()
        assert waits.spare == 0.0
    assert notebook.now is time.monotonic


@pytest.mark.parametrize("value", [datetime, datetime.datetime])
def test_who_has_imported_datetime_is_taken_to_look_at_it(
    monkeypatch: pytest.MonkeyPatch, value: object
) -> None:
    monkeypatch.setattr(sys.modules["__main__"], "datetime", value, raising=False)
    waits = ShorterWaits(lambda: True)
    waits.begin_run(spare=12.0)
    assert waits.spare == 0.0


async def _within_a_limit() -> None:
    async with asyncio.timeout(60.0):
        pass


@pytest.mark.parametrize(
    "set_a_timer",
    [lambda: asyncio.run(_within_a_limit()), lambda: threading.Timer(60.0, print, args=())],
)
def test_who_sets_a_timer_waits_in_full(set_a_timer: Callable[[], object]) -> None:
    subject = False
    with ShorterWaits(lambda: subject) as waits:
        waits.begin_run(spare=12.0)
        set_a_timer()
        assert waits.spare == 12.0  # another's
        subject = True
        set_a_timer()
        assert waits.spare == 0.0


def test_so_does_who_has_a_second_thread_that_sleeps(monkeypatch: pytest.MonkeyPatch) -> None:
    asleep, awake = threading.Event(), threading.Event()
    sleep = time.sleep

    def slept(seconds: float) -> None:
        if seconds < 60.0:
            sleep(seconds)
            return
        asleep.set()
        awake.wait()

    monkeypatch.setattr(time, "sleep", slept)
    nobody = client(ready=threading.Event())
    with ShorterWaits(lambda: True) as waits:
        waits.begin_run(spare=12.0)
        thread = threading.Thread(target=lambda: time.sleep(60.0))
        thread.start()
        asleep.wait()
        assert not Client.wait_for_service(nobody, 0.05)
        assert waits.spare == 0.0
        awake.set()
        thread.join()


def test_a_look_of_rclpys_own_at_a_clock_changes_nothing() -> None:
    with ShorterWaits(lambda: True) as waits:
        waits.begin_run(spare=12.0)
        exec(compile("time.monotonic()", rclpy.client.__file__, "exec"), {"time": time})
        assert waits.spare == 12.0


def test_everything_is_put_back() -> None:
    before = (
        time.monotonic,
        time.sleep,
        Client.wait_for_service,
        ActionClient.wait_for_server,
        Node.get_service_names_and_types,
    )
    with ShorterWaits(lambda: True), GraphQuestions(lambda: None, lambda: True):
        assert time.sleep is not before[1]
    after = (
        time.monotonic,
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
    with ShorterWaits(lambda: subject) as waits:
        time.sleep(0.5)
        waits.begin_run(factor=0.1)
        time.sleep(0.5)
        time.sleep(0.001)
        subject = False
        time.sleep(0.5)
    assert slept == pytest.approx([0.5, 0.05, 0.001, 0.5])


def test_a_hung_wait_looks_like_rclpys_own() -> None:
    ready = threading.Event()
    with CapturedOutput(lambda _, __: None) as captured, ShorterWaits(captured.is_captured):
        thread = threading.Thread(target=lambda: Client.wait_for_service(client(ready=ready)), daemon=True)
        thread.start()
        while "wait_for_service" not in (stacks := captured.stacks()):
            time.sleep(0.001)
        ready.set()
        thread.join()
    assert f'File "{rclpy.client.__file__}"' in stacks
    assert "notebook/checking/shorter_waits.py" not in stacks.replace(__file__, "")


def test_looks_at_the_graph_are_told_up_to_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Node, "get_service_names_and_types", lambda _: ["the answer"])
    told: list[int] = []
    subject = True
    with GraphQuestions(lambda: told.append(1), lambda: subject) as questions:
        for _ in range(LOOKS_TOLD + 5):
            assert Node.get_service_names_and_types(None) == ["the answer"]  # type: ignore[arg-type, comparison-overlap]
        assert len(told) == LOOKS_TOLD
        questions.begin_run()
        subject = False
        Node.get_service_names_and_types(None)  # type: ignore[arg-type]
        assert len(told) == LOOKS_TOLD
