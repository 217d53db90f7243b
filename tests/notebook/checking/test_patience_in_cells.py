"""Functions of a notebook that are told how long to wait: who keeps that time, and who only looks as if."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.notebook.checked import Checked, Diagnosed

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def adder(wait: Callable[[Any, float], bool], *, answer_within: float | None = None) -> Any:
    """A client of Lab 1.3 that waits for its service in a given way, and for its answer as long as it is told."""

    def add_two_ints(a: int, b: int, patience_sec: float = 5.0) -> int:
        node = rclpy.create_node("adder")
        try:
            client = node.create_client(AddTwoInts, "add_two_ints")
            if not wait(client, patience_sec):
                raise TimeoutError("add_two_ints is not available")
            future = client.call_async(AddTwoInts.Request(a=a, b=b))
            rclpy.spin_until_future_complete(node, future, timeout_sec=answer_within or patience_sec)
            if not future.done():
                raise TimeoutError("no answer")
            node.get_logger().info(f"the sum is {future.result().sum}")
            return future.result().sum
        finally:
            node.destroy_node()

    return add_two_ints


def waits(client: Any, patience: float) -> bool:
    return bool(client.wait_for_service(timeout_sec=patience))


def in_whole_seconds(client: Any, patience: float) -> bool:
    return any(client.wait_for_service(timeout_sec=1.0) for _ in range(int(patience)))


def until_a_deadline(client: Any, patience: float) -> bool:
    deadline = time.monotonic() + patience
    while not client.service_is_ready() and time.monotonic() < deadline:
        time.sleep(0.05)
    return bool(client.service_is_ready())


def in_rounds_until_a_deadline(client: Any, patience: float) -> bool:
    """The loop of the official tutorial, with an end."""
    deadline = time.monotonic() + patience
    while not client.wait_for_service(timeout_sec=1.0):
        if time.monotonic() > deadline:
            return False
    return True


def within_a_limit_of_asyncio(client: Any, patience: float) -> bool:
    async def in_rounds() -> bool:
        try:
            async with asyncio.timeout(patience):
                while not client.wait_for_service(timeout_sec=0.1):
                    await asyncio.sleep(0)
        except TimeoutError:
            return False
        return True

    return asyncio.run(in_rounds())


def in_a_thread_of_asyncio(client: Any, patience: float) -> bool:
    async def in_rounds() -> bool:
        stopped = threading.Event()

        def wait() -> None:
            while not (stopped.is_set() or client.wait_for_service(timeout_sec=0.1)):
                pass

        try:
            await asyncio.wait_for(asyncio.to_thread(wait), patience)
        except TimeoutError:
            return False
        finally:
            stopped.set()
        return True

    return asyncio.run(in_rounds())


def until_a_timer_ends_it(client: Any, patience: float) -> bool:
    expired = threading.Event()
    timer = threading.Timer(patience, expired.set)
    timer.start()
    while not expired.is_set():
        if client.wait_for_service(timeout_sec=0.1):
            timer.cancel()
            return True
    return False


def until_a_timer_of_ros_ends_it(client: Any, patience: float) -> bool:
    expired = threading.Event()
    node = rclpy.create_node("watchdog")
    node.create_timer(patience, expired.set)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    while not (expired.is_set() or client.wait_for_service(timeout_sec=0.1)):
        pass
    executor.shutdown()
    return bool(client.service_is_ready())


def until_a_thread_has_slept(client: Any, patience: float) -> bool:
    expired = threading.Event()

    def expire() -> None:
        time.sleep(patience)
        expired.set()

    threading.Thread(target=expire, daemon=True).start()
    while not (expired.is_set() or client.wait_for_service(timeout_sec=0.1)):
        pass
    return bool(client.service_is_ready())


def never_where_it_is_short(client: Any, patience: float) -> bool:
    return patience >= 1.0 and bool(client.wait_for_service())


@pytest.mark.parametrize(
    "wait",
    [
        waits,
        in_whole_seconds,
        until_a_deadline,
        in_rounds_until_a_deadline,
        within_a_limit_of_asyncio,
        in_a_thread_of_asyncio,
        until_a_timer_ends_it,
        until_a_timer_of_ros_ends_it,
        until_a_thread_has_slept,
    ],
)
def test_who_keeps_the_patience_is_right(wait: Any, checked: Checked) -> None:
    verdict = checked("lab_1_3.client", adder(wait))
    assert verdict.passed, [f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed]


def greets(a: int, b: int, patience_sec: float = 5.0) -> None:
    """A function whose node is gone before the graph tells of it."""
    node = rclpy.create_node("adder")
    print(f"I ask for the sum of {a} and {b}.")
    node.destroy_node()


@pytest.mark.parametrize(
    ("function", "diagnosis"),
    [
        pytest.param(adder(lambda c, _: waits(c, 5.0)), "patience_not_kept", id="a limit of its own"),
        pytest.param(
            adder(never_where_it_is_short), "waits_forever", id="gives up at once where patience is short"
        ),
        pytest.param(adder(lambda c, _: waits(c, 0.01)), "gave_up_too_early", id="a hundredth of a second"),
        pytest.param(greets, "nothing_on_the_graph", id="is gone before the graph tells of its node"),
        pytest.param(
            adder(lambda c, _: c.service_is_ready()),
            "gave_up_too_early",
            id="looks once, and raises an error",
        ),
        pytest.param(
            adder(waits, answer_within=0.01), "result_read_too_early", id="a hundredth for the answer"
        ),
    ],
)
def test_who_waits_by_another_limit_is_wrong(function: Any, diagnosis: str, diagnosed: Diagnosed) -> None:
    assert diagnosed("lab_1_3.client", function).key == diagnosis


def asks_again(a: int, b: int, patience_sec: float = 5.0) -> int:
    """A client that waits for no service: it sends its request again until there is an answer."""
    node = rclpy.create_node("adder")
    try:
        client = node.create_client(AddTwoInts, "add_two_ints")
        for _ in range(int(2 * patience_sec)):
            future = client.call_async(AddTwoInts.Request(a=a, b=b))
            rclpy.spin_until_future_complete(node, future, timeout_sec=0.5)
            if future.done():
                node.get_logger().info(f"the sum is {future.result().sum}")
                return future.result().sum
        raise TimeoutError("no answer")
    finally:
        node.destroy_node()


def sends_a_goal_at_once(order: int, patience_sec: float = 5.0) -> None:
    node = rclpy.create_node("fibonacci_client")
    try:
        future = ActionClient(node, Fibonacci, "fibonacci").send_goal_async(Fibonacci.Goal(order=order))
        rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
        if not future.done():
            raise TimeoutError("no answer")
    finally:
        node.destroy_node()


@pytest.mark.parametrize(
    ("exercise", "function"),
    [("lab_1_3.client", adder(lambda *_: True)), ("lab_1_4.client", sends_a_goal_at_once)],
)
def test_a_call_before_the_server_is_there_is_told_after_one_run(
    exercise: str, function: Any, checked: Checked
) -> None:
    verdict = checked(exercise, function)
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "called_too_early"
    assert {moment.part for moment in verdict.timeline} == {""}


def test_a_client_that_asks_again_finds_the_late_service(checked: Checked) -> None:
    verdict = checked("lab_1_3.client", asks_again)
    found = {criterion.name: criterion.passed for criterion in verdict.criteria}
    assert found["late"]
    assert found["sum"]
