"""Nodes on paper: what rclpy gives to a program, without a network.

Messages and services are the real classes, and go through real serialization. Parameters are rclpy's own code. Only the
solution and its mutants run like this, never a student's program: executors, stacks and discovery do not exist here.
"""

from __future__ import annotations

import asyncio
import threading
import time
from functools import partial
from typing import Any

import rclpy.clock
import rclpy.node
from rclpy.clock import ClockType
from rclpy.parameter_service import ParameterService
from rclpy.time import Time

from autograder.authoring.paper.actions import replace_actions
from autograder.authoring.paper.endpoints import (
    Client,
    PaperTimer,
    Publisher,
    Service,
    Subscription,
    profile_of,
)
from autograder.authoring.paper.loops import PaperLoops
from autograder.authoring.paper.network import SECOND, Hangs, Network, UnknownOnPaper


class RobotClock:
    """The clock of a node."""

    clock_type = ClockType.ROS_TIME

    def now(self) -> Time:
        """Return the robot's time."""
        return Time(nanoseconds=Network.now_running.time, clock_type=ClockType.ROS_TIME)


class ComputerClock:
    """A clock of rclpy that a program makes itself: it does not follow simulated time."""

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> None:
        self.clock_type = clock_type

    def now(self) -> Time:
        """Return the computer's time."""
        return Time(nanoseconds=Network.now_running.wall, clock_type=self.clock_type)


class _Logger:
    def __init__(self, name: str) -> None:
        self.name = name
        for level, words in ((10, "debug"), (20, "info"), (30, "warning"), (40, "error"), (50, "fatal")):
            setattr(self, words, partial(self._log, level))
        self.warn = self.warning  # type: ignore[attr-defined]

    def _log(self, level: int, text: object, **_: object) -> bool:
        Network.now_running.logged(self.name, level, str(text))
        return True

    def set_level(self, _: object) -> None:
        """Do nothing: every line is taken."""


class _Unheard:
    def publish(self, _: object) -> None:
        """Do nothing: no node listens to changed parameters."""


class PaperNode(rclpy.node.Node):
    """A node of a program. Of rclpy's own node, it keeps the parameters, and replaces what needs a network."""

    def __init__(self, node_name: str, **options: Any) -> None:
        options.pop("context", None)
        if unknown := options.keys() - {"namespace", "allow_undeclared_parameters", "use_global_arguments"}:
            raise UnknownOnPaper(f"Node({', '.join(sorted(unknown))}=…)")
        self._name = node_name
        self._namespace = f"/{options.get('namespace', '').strip('/')}".rstrip("/")
        self._publishers, self._subscriptions, self._timers = [], [], []
        self._services, self._clients = [], []
        self._parameters, self._parameter_overrides, self._descriptors = {}, {}, {}
        self._pre_set_parameters_callbacks, self._on_set_parameters_callbacks = [], []
        self._post_set_parameters_callbacks = []
        self._allow_undeclared_parameters = options.get("allow_undeclared_parameters", False)
        self._parameter_event_publisher = _Unheard()  # type: ignore[assignment]
        self._clock, self._logger = RobotClock(), _Logger(node_name)  # type: ignore[assignment]
        Network.now_running.nodes.append(self)
        self._parameter_service = ParameterService(self)

    @property
    def full_name(self) -> str:
        """The name of the node with its namespace."""
        return f"{self._namespace}/{self._name}"

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the full name of a topic."""
        del only_expand
        if topic.startswith("~"):
            return self.full_name + topic[1:]
        return topic if topic.startswith("/") else f"{self._namespace}/{topic}"

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the full name of a service."""
        return self.resolve_topic_name(service, only_expand=only_expand)

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any, **_: Any) -> Any:
        """Make a publisher."""
        made = Publisher(msg_type, self.resolve_topic_name(topic), profile_of(qos_profile))
        self._publishers.append(made)  # type: ignore[arg-type]
        return made

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, **_: Any
    ) -> Any:
        """Make a subscription."""
        made = Subscription(msg_type, self.resolve_topic_name(topic), callback, profile_of(qos_profile))
        self._subscriptions.append(made)  # type: ignore[arg-type]
        return made

    def create_service(self, srv_type: Any, srv_name: str, callback: Any, **_: Any) -> Any:
        """Make a service."""
        made = Service(srv_type, self.resolve_topic_name(srv_name), callback)
        self._services.append(made)  # type: ignore[arg-type]
        return made

    def create_client(self, srv_type: Any, srv_name: str, **_: Any) -> Any:
        """Make a client."""
        made = Client(srv_type, self.resolve_topic_name(srv_name))
        self._clients.append(made)  # type: ignore[arg-type]
        return made

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Any,
        callback_group: Any = None,
        clock: Any = None,
        autostart: bool = True,
    ) -> Any:
        """Make a timer of the robot's clock."""
        del callback_group
        if clock not in (None, self._clock):
            raise UnknownOnPaper("a timer of another clock")
        made = PaperTimer(timer_period_sec, callback, autostart=autostart)
        self._timers.append(made)  # type: ignore[arg-type]
        return made

    def destroy_publisher(self, publisher: Any) -> bool:
        """Remove a publisher."""
        return _removed(self._publishers, publisher)

    def destroy_subscription(self, subscription: Any) -> bool:
        """Remove a subscription."""
        return _removed(self._subscriptions, subscription)

    def destroy_service(self, service: Any) -> bool:
        """Remove a service."""
        return _removed(self._services, service)

    def destroy_client(self, client: Any) -> bool:
        """Remove a client."""
        return _removed(self._clients, client)

    def destroy_timer(self, timer: Any) -> bool:
        """Remove a timer."""
        return _removed(self._timers, timer)

    def destroy_node(self) -> None:
        """Remove everything that the node has."""
        for ends in (
            self._publishers,
            self._subscriptions,
            self._timers,
            self._services,
            self._clients,
        ):
            ends.clear()

    def get_name(self) -> str:
        """Return the name."""
        return self._name

    def get_namespace(self) -> str:
        """Return the namespace."""
        return self._namespace or "/"

    def get_fully_qualified_name(self) -> str:
        """Return the name with its namespace."""
        return self.full_name

    def count_subscribers(self, topic_name: str) -> int:
        """Return 1: the bench listens to every topic."""
        del topic_name
        return 1


def _removed(ends: Any, end: Any) -> bool:
    if end not in ends:
        return False
    ends.remove(end)
    return True


class _Thread(threading.Thread):
    """A thread of the program, which says whether it runs."""

    def start(self) -> None:
        Network.now_running.threads.began(1)
        super().start()

    def run(self) -> None:
        threads = Network.now_running.threads
        try:
            super().run()
        finally:
            threads.began(-1)

    def join(self, timeout: float | None = None) -> None:
        here = threading.current_thread()
        if here is Network.now_running.main:
            Network.now_running.threads.settle()
            if self.is_alive():
                raise Hangs
            return
        threads = Network.now_running.threads
        threads.began(-1)
        super().join(timeout)
        threads.began(1)


def _computers_seconds() -> float:
    return Network.now_running.wall / SECOND


def _sleep(seconds: float) -> None:
    if threading.current_thread() is Network.now_running.main:
        Network.now_running.wall += round(seconds * SECOND)
    else:
        threads = Network.now_running.threads
        threads.began(-1)
        threading.Event().wait()  # the computer's time stands still for a thread


def replace_rclpy() -> None:
    """Put nodes, clocks, threads and loops on paper into the places of the real ones, in this process for good.

    Call it in a process that was made for one program.
    """
    replace_actions()
    rclpy.node.Node = PaperNode  # type: ignore[misc]
    rclpy.clock.Clock = ComputerClock  # type: ignore[assignment,misc]
    threading.Thread = _Thread  # type: ignore[misc]
    asyncio.set_event_loop_policy(PaperLoops())
    time.time = time.monotonic = time.perf_counter = _computers_seconds
    time.time_ns = time.monotonic_ns = lambda: Network.now_running.wall
    time.sleep = _sleep  # type: ignore[assignment]
