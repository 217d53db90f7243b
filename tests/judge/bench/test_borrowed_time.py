"""Simulated time for a node that lives in real time, and its own time back."""

from __future__ import annotations

import time
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from rclpy.executors import SingleThreadedExecutor

from autograder.judge.bench.borrowed_time import BorrowedTime
from autograder.judge.bench.graph import NodeName
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.wire import Wire
from autograder.judge.serving import domain

if TYPE_CHECKING:
    from conftest import Spun, SubjectNode

pytestmark = pytest.mark.ros


def test_timers_fire_as_they_would_later_on_and_the_clock_is_given_back(
    subject_node: SubjectNode, spun: Spun
) -> None:
    fired: list[float] = []
    with domain.lease() as domain_id, Wire(domain_id) as wire, subject_node(domain_id) as node:
        node.create_timer(20.0, lambda: fired.append(node.get_clock().now().nanoseconds / 1e9))
        with spun(SingleThreadedExecutor(context=node.context), node):
            began = time.time()
            with closing(BorrowedTime(wire, Recorder(), NodeName("subject", "/"))) as borrowed:
                # A machine that is busy for half a second ends it before its time; the judge then waits instead.
                assert any(borrowed.let_pass(50.0, lambda: False) for _ in range(20))
            assert len(fired) >= 2
            assert all(moment - began >= 19.0 for moment in fired)
            assert not node.get_parameter("use_sim_time").value
            assert abs(node.get_clock().now().nanoseconds / 1e9 - time.time()) < 5.0


def test_who_is_not_spun_does_not_go_along(subject_node: SubjectNode) -> None:
    with (
        domain.lease() as domain_id,
        Wire(domain_id) as wire,
        subject_node(domain_id),
        closing(BorrowedTime(wire, Recorder(), NodeName("subject", "/"))) as borrowed,
    ):
        assert not borrowed.let_pass(5.0, lambda: False)
