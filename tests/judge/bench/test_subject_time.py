"""The time of a subject: when the judge goes on to the next step, the timers of this one have been called."""

from __future__ import annotations

import sys
import threading
import time
from contextlib import ExitStack, closing
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any
from unittest.mock import MagicMock

import pytest
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter

from autograder.judge import ros_setup
from autograder.judge.bench import subject_time
from autograder.judge.bench.discovery import NodeName
from autograder.judge.bench.judge_nodes import Wire
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.subject_time import FIRST, NodeClock, SimulatedClock, SubjectTime
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Part, Reference
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

    from conftest import BenchOf, Spun, SubjectNode
    from rclpy.node import Node

pytestmark = pytest.mark.ros

OFF_THE_PROCESSOR = 0.03
"""Seconds after each answer in which the judge may ask again, or go on."""


class QuestionFirst(SingleThreadedExecutor):
    """Sees a question before the time that was published before it, as may happen where both arrive while it looks.

    After each answer it is off the processor for a moment.
    """

    asked = False

    def can_execute(self, entity: Any) -> bool:
        if getattr(entity, "topic_name", "").endswith("/clock"):
            return self.asked and super().can_execute(entity)
        return super().can_execute(entity)

    def watch(self, node: Node) -> None:
        """Be off the processor after each question about a parameter."""
        service = next(s for s in node.services if s.service_name.endswith("/get_parameters"))
        answer: Callable[..., Any] = service.callback

        def answer_and_pause(request: Any, response: Any) -> Any:
            self.create_task(self._pause)
            return answer(request, response)

        service.callback = answer_and_pause

    def miss_the_next_time(self) -> None:
        """See the next time only when there was another question."""
        done = threading.Event()

        def begin() -> None:
            self.asked = False
            done.set()

        # Behind the pauses that are due.
        self.create_task(begin)
        done.wait()

    def _pause(self) -> None:
        time.sleep(OFF_THE_PROCESSOR)
        self.asked = True


def test_the_timers_of_a_step_are_called_before_the_next_one_where_a_question_overtakes_the_time(
    subject_node: SubjectNode, spun: Spun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(subject_time, "ANSWER_LIMIT", 30.0)
    fired: list[float] = []
    with (
        ros_setup.lease_domain() as domain_id,
        closing(Wire(domain_id)) as wire,
        subject_node(domain_id) as node,
    ):
        executor = QuestionFirst(context=node.context)
        executor.watch(node)

        def on_timer() -> None:
            fired.append(round(node.get_clock().now().nanoseconds / 1e9, 3))

        with spun(executor, node), closing(NodeClock(wire, Recorder(), NodeName("subject", "/"))) as clock:
            assert clock.follow(True)
            assert clock.is_heard()
            assert clock.show(100.0)
            node.create_timer(1.0, on_timer)
            for now in (101.0, 102.0, 103.0):
                executor.miss_the_next_time()
                assert clock.show(now)
                assert fired[-1:] == [now]


def test_timers_fire_as_they_would_later_on_and_the_clock_is_given_back(
    subject_node: SubjectNode, spun: Spun
) -> None:
    fired: list[float] = []
    with (
        ros_setup.lease_domain() as domain_id,
        closing(Wire(domain_id)) as wire,
        subject_node(domain_id) as node,
    ):
        node.create_timer(20.0, lambda: fired.append(node.get_clock().now().nanoseconds / 1e9))
        with spun(SingleThreadedExecutor(context=node.context), node):
            began = time.time()
            with closing(NodeClock(wire, Recorder(), NodeName("subject", "/"))) as borrowed:
                # A machine that is busy for half a second ends it before its time; the judge then waits instead.
                assert any(borrowed.lend(50.0, lambda: False) for _ in range(20))
            assert len(fired) >= 2
            assert all(moment - began >= 19.0 for moment in fired)
            assert not node.get_parameter("use_sim_time").value
            assert abs(node.get_clock().now().nanoseconds / 1e9 - time.time()) < 5.0


def test_a_node_s_own_callbacks_of_parameters_do_not_hear_of_the_judge_s_clock(
    subject_node: SubjectNode, spun: Spun
) -> None:
    if not (Path(sys.prefix) / "share/rclpy").is_dir():
        pytest.skip("a ROS that was sourced is as it is")
    heard: list[str] = []

    def refuse(parameters: list[Parameter]) -> SetParametersResult:
        heard.extend(one.name for one in parameters)
        return SetParametersResult(successful=False, reason="not mine")

    def keep(parameters: list[Parameter]) -> list[Parameter]:
        heard.extend(one.name for one in parameters)
        return parameters

    with (
        ros_setup.lease_domain() as domain_id,
        closing(Wire(domain_id)) as wire,
        subject_node(domain_id) as node,
    ):
        node.declare_parameter("speed", 0.5)
        node.add_pre_set_parameters_callback(keep)
        node.add_on_set_parameters_callback(refuse)
        node.add_post_set_parameters_callback(keep)
        with (
            spun(SingleThreadedExecutor(context=node.context), node),
            closing(SimulatedClock(wire, Recorder(), NodeName("subject", "/"))) as clock,
        ):
            assert clock.take_over()
            assert node.get_clock().now().nanoseconds / 1e9 == FIRST
        assert heard == []
        (result,) = node.set_parameters([Parameter("speed", value=0.7)])
        assert (result.reason, heard) == ("not mine", ["speed", "speed"])


def test_a_scenario_says_how_much_time_passes_at_once(subject_node: SubjectNode, spun: Spun) -> None:
    fired: list[float] = []
    with (
        ros_setup.lease_domain() as domain_id,
        closing(Wire(domain_id)) as wire,
        subject_node(domain_id) as node,
        spun(SingleThreadedExecutor(context=node.context), node),
        closing(SimulatedClock(wire, Recorder(), NodeName("subject", "/"))) as clock,
    ):
        assert clock.take_over()
        node.create_timer(0.1, lambda: fired.append(node.get_clock().now().nanoseconds / 1e9))
        assert clock.run(1.0, lambda: False, step=0.25)
        assert clock.run(0.3, lambda: False, step=0.25)
    assert [round(now - FIRST, 3) for now in fired] == [0.25, 0.5, 0.75, 1.0, 1.25, 1.3]


def test_a_message_of_each_node_may_have_been_on_its_way_when_the_clock_stopped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events = [Event(0.1, "message", "/chatter"), Event(0.1, "message", "/beside")]
    recorder = SimpleNamespace(part=lambda: Part("talking", {}, list(events)))
    presence = MagicMock(recorder=recorder, subscriptions={"/chatter": None, "/news": None})
    presence.counterparts.return_value = [NodeName("one", "/"), NodeName("other", "/")]
    wire, clock = MagicMock(), MagicMock()
    wire.node.count_publishers.return_value = 1
    monkeypatch.setattr(subject_time, "SimulatedClock", clock)
    SubjectTime(wire, presence, MagicMock(), MagicMock())._clock_taken_over()
    (is_silent,) = clock.return_value.stands_still.call_args.args
    silent = []
    for topic in ("/beside", "/chatter", "/news", "/chatter"):
        events.append(Event(0.2, "message", topic))
        silent.append(is_silent())
    assert silent == [True, True, True, False]


def test_who_is_not_spun_does_not_go_along(subject_node: SubjectNode) -> None:
    with (
        ros_setup.lease_domain() as domain_id,
        closing(Wire(domain_id)) as wire,
        subject_node(domain_id),
        closing(NodeClock(wire, Recorder(), NodeName("subject", "/"))) as borrowed,
    ):
        assert not borrowed.lend(5.0, lambda: False)


def test_one_clock_steps_every_node_that_the_judge_meets(subject_node: SubjectNode, spun: Spun) -> None:
    fired: dict[str, list[float]] = {"left": [], "right": []}
    with ros_setup.lease_domain() as domain_id, closing(Wire(domain_id)) as wire, ExitStack() as opened:
        for space, ticks in fired.items():
            node = opened.enter_context(subject_node(domain_id, namespace=space))
            node.create_timer(0.5, lambda ticks=ticks, node=node: ticks.append(seconds(node)))
            opened.enter_context(spun(SingleThreadedExecutor(context=node.context), node))
        names = [NodeName("subject", f"/{space}") for space in fired]
        clock = opened.enter_context(closing(SimulatedClock(wire, Recorder(), *names)))
        assert clock.take_over()
        for ticks in fired.values():
            ticks.clear()
        assert clock.run(2.0, lambda: False)
        assert [len(ticks) for ticks in fired.values()] == [4, 4]


SLEEPER = cases(__file__, "SLEEPER")
"""A program whose callback sleeps, which costs nothing while the judge's clock waits for it."""


def test_a_callback_that_sleeps_has_to_be_confirmed_in_real_time(bench_of: BenchOf) -> None:
    text = "std_msgs/msg/String"
    reference = Reference("a test", {"publisher": {"/told": text}, "subscription": {"/ask": text}})
    with bench_of(SLEEPER, reference, Pace.FAST) as bench:
        bench.part("only")
        bench.listen("/told", text)
        asks = bench.speak("/ask", text)
        bench.start()
        bench.await_endpoint("subscription", "/ask")
        bench.await_attention()
        assert bench.run_time(0.1)
        # The steps before may have been slow on a busy machine.
        bench.doubtful = False
        asks.send(data="a question")
        bench.settle()
        assert bench.doubtful
        bench.stop()


def seconds(node: Node) -> float:
    """The time of a node."""
    return node.get_clock().now().nanoseconds / 1e9
