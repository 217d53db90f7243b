"""Simulated time for a node that lives in real time, and its own time back."""

from __future__ import annotations

import threading
import time
from contextlib import closing

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from autograder.judge.bench.borrowed_time import BorrowedTime
from autograder.judge.bench.graph import NodeName
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.wire import Wire
from autograder.judge.serving import domain

pytestmark = pytest.mark.ros


def test_timers_fire_as_they_would_later_on_and_the_clock_is_given_back() -> None:
    fired: list[float] = []
    with domain.lease() as domain_id, Wire(domain_id) as wire:
        context = Context()
        context.init(domain_id=domain_id)
        node = Node("subject", context=context)
        node.create_timer(20.0, lambda: fired.append(node.get_clock().now().nanoseconds / 1e9))
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        try:
            began = time.time()
            with closing(BorrowedTime(wire, Recorder(), NodeName("subject", "/"))) as borrowed:
                # A machine that is busy for half a second ends it before its time; the judge then waits instead.
                assert any(borrowed.let_pass(50.0, lambda: False) for _ in range(20))
            assert len(fired) >= 2
            assert all(moment - began >= 19.0 for moment in fired)
            assert not node.get_parameter("use_sim_time").value
            assert abs(node.get_clock().now().nanoseconds / 1e9 - time.time()) < 5.0
        finally:
            executor.shutdown()
            thread.join()
            node.destroy_node()
            context.try_shutdown()


def test_who_is_not_spun_does_not_go_along() -> None:
    with domain.lease() as domain_id, Wire(domain_id) as wire:
        context = Context()
        context.init(domain_id=domain_id)
        node = Node("subject", context=context)
        try:
            with closing(BorrowedTime(wire, Recorder(), NodeName("subject", "/"))) as borrowed:
                assert not borrowed.let_pass(5.0, lambda: False)
        finally:
            node.destroy_node()
            context.try_shutdown()
