"""The judge's own nodes: the one that observes the subject, and decoys, which exist only for a subject to find.

Each node has its own ROS context, and so its own DDS participant. The node that observes is spun by its own thread.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient, ActionServer
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import NameValidationException
from rclpy.node import Node

from autograder.dds_discovery import receivers_wait
from autograder.judge.bench.batch_executor import BatchExecutor, InvalidHandle
from autograder.judge.bench.discovery import topic_endpoints
from autograder.judge.bench.qos_profiles import profile
from autograder.judge.bench.ros_interfaces import interface
from autograder.judge.machine_fitness import Patience

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rclpy.qos import QoSProfile

    from autograder.judge.bench.discovery import Endpoint
    from autograder.kit.counterparts import Qos


TAKEN_IN = 5.0
"""Time limit in seconds for the judge to process what was sent to it."""
SPIN_POLL = 0.05
"""Seconds between two checks whether the spinning thread still runs."""


class _QuietNode(Node):
    """A node whose endpoints report only the QoS events that were requested.

    By default, rclpy gives each endpoint two events that only log a warning. These events would cost time, because the
    executor checks all events in each round, and a check in simulated time has some hundred rounds.
    """

    def create_publisher(self, *arguments: Any, **options: Any) -> Any:
        options.setdefault("event_callbacks", PublisherEventCallbacks(use_default_callbacks=False))
        return super().create_publisher(*arguments, **options)

    def create_subscription(self, *arguments: Any, **options: Any) -> Any:
        options.setdefault("event_callbacks", SubscriptionEventCallbacks(use_default_callbacks=False))
        return super().create_subscription(*arguments, **options)


class _NeverReady:
    """Stands for a client of a service that cannot exist."""

    def service_is_ready(self) -> bool:
        return False


class Wire:
    """The judge's DDS participant on one ROS domain, with one node, and with its own ROS context and thread.

    Attributes:
        node: The judge's node. It has no parameter services and no log topic, so that it adds almost nothing to the
            graph.
        executor: Spins the node in a thread of its own.
        failure: The exception of a callback of the judge that ended this thread; None if there was none.
    """

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        self.context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        with receivers_wait():
            self.node: Node = _QuietNode(
                f"judge_{secrets.token_hex(4)}",
                context=self.context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        self.executor = BatchExecutor(self.node)
        self.failure: BaseException | None = None
        self._thread = threading.Thread(target=self._spin, name="judge wire", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while True:
            try:
                self.executor.spin()
            except InvalidHandle:
                continue  # a part has ended and destroyed an entity that was in use
            except (
                BaseException
            ) as error:  # raised by the judge's own callback: no later result can be trusted
                self.failure = error
            return

    def client(self, kind: Any, service: str, **how: Any) -> Any:
        """Return a client; one that is never ready if no service can have this name.

        A node's name may be so long that the names of its parameter services would be longer than ROS allows.
        """
        try:
            return self.node.create_client(kind, service, **how)
        except NameValidationException:
            return _NeverReady()

    def count_servers(self, service: str) -> int:
        """Return how many servers of this name the graph shows."""
        with contextlib.suppress(NameValidationException):
            return self.node.count_services(service)
        return 0

    def take_in(self) -> bool:
        """Wait until everything that had been sent to the judge is recorded. Return True if this succeeds in time.

        This must not be called from a callback of the judge.
        """
        patience = Patience(TAKEN_IN)
        if not await_turns(patience):
            return False
        taken = threading.Event()
        self.executor.do(taken.set)
        while self._thread.is_alive() and patience.left > 0:
            if taken.wait(SPIN_POLL):
                return True
        return False

    def close(self) -> None:
        """Stop spinning, join the thread and leave the domain. An unjoined thread would later abort the interpreter."""
        self.executor.stop()
        self._thread.join(timeout=2.0)
        self.node.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()


class DecoyNodes:
    """The judge's decoy nodes, each with its own DDS participant.

    Each node needs its own participant, because within one participant Fast DDS accepts only one type for each topic.
    Participants are kept from part to part, because a subject that keeps running needs a fifth of a second or more to
    discover a new participant. A participant exists only as long as it has a node (rmw_fastrtps), so an old node is
    removed only when the next node exists.
    """

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self._decoys: list[_Decoy] = []
        self._planted = 0

    def plant(
        self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str], qos: Qos
    ) -> set[Endpoint]:
        """Put a node on the graph, with publishers and subscriptions for these topics. The node is not spun.

        Returns:
            The identifiers of the node's endpoints on these topics.
        """
        if self._planted == len(self._decoys):
            self._decoys.append(_Decoy(self._domain_id))
        decoy = self._decoys[self._planted]
        self._planted += 1
        return decoy.plant(name, publishes, subscribes, profile(qos))

    def clear(self) -> None:
        """Remove the endpoints from the graph. The nodes stay until the next decoys replace them."""
        for decoy in self._decoys[: self._planted]:
            decoy.clear()
        self._planted = 0

    def close(self) -> None:
        """Remove the decoy nodes and their participants."""
        while self._decoys:
            self._decoys.pop().close()


_ACTION, _FEEDBACK = "/action/", "/_action/feedback"


class _Decoy:
    """One DDS participant of the judge, with the decoy node that it currently shows on the graph."""

    def __init__(self, domain_id: int) -> None:
        self._context = Context()
        self._context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        self._node: Node | None = None
        self._ends = contextlib.ExitStack()

    def plant(
        self, called: str, publishes: Mapping[str, str], subscribes: Mapping[str, str], qos: QoSProfile
    ) -> set[Endpoint]:
        with receivers_wait() if self._node is None else contextlib.nullcontext():
            space, _, own = called.rpartition("/")
            node = Node(own, namespace=space, context=self._context, use_global_arguments=False)
        self._destroy()
        self._node = node
        for name, type_name in publishes.items():
            kind = interface(type_name)
            if _ACTION in type_name:
                self._ends.callback(ActionServer(node, kind, name, lambda _: None).destroy)
            else:
                self._ends.callback(node.destroy_publisher, node.create_publisher(kind, name, qos))
        for name, type_name in subscribes.items():
            kind = interface(type_name)
            if _ACTION in type_name:
                self._ends.callback(ActionClient(node, kind, name).destroy)
            else:
                subscription = node.create_subscription(kind, name, lambda _: None, qos)
                self._ends.callback(node.destroy_subscription, subscription)
        ends = [*publishes.items(), *subscribes.items()]
        return topic_endpoints(node, [f"{name}{_FEEDBACK * (_ACTION in kind)}" for name, kind in ends])

    def clear(self) -> None:
        self._ends.close()

    def _destroy(self) -> None:
        self.clear()
        if self._node is not None:
            self._node.destroy_node()

    def close(self) -> None:
        self._destroy()
        self._context.try_shutdown()
        self._context.destroy()


THREAD_POLL = 0.001
"""Seconds between two checks of a thread."""
SLEEP_ROUNDS = 2
"""The number of rounds to wait. In the first round, a thread may finish its work and wake another thread. The second
round waits for that thread.
"""


@dataclass(frozen=True)
class _Thread:
    """The state of a thread, as the kernel reports it (proc_pid_stat(5), proc_pid_status(5)).

    Attributes:
        awake: True if the thread runs, or waits for a processor.
        slept: The number of times that the thread has gone to sleep; 0 if it sleeps now.
    """

    awake: bool
    slept: int


def await_turns(patience: Patience) -> bool:
    """Wait until each thread of the middleware that is awake has slept once. Return False if the time is up first.

    The judge learns of a program's end through a pipe, but of the program's messages through threads of the middleware.
    So on a busy machine, the judge may learn of the end while such a thread, woken by a message, still waits for a
    processor. A sleeping thread has no message left, because a message wakes its thread at once (futex(7), udp(7)).
    """
    return all(_await_turn(patience) for _ in range(SLEEP_ROUNDS))


def _await_turn(patience: Patience) -> bool:
    pause = threading.Event()
    python = {thread.native_id for thread in threading.enumerate()}
    tasks = (int(task.name) for task in os.scandir("/proc/self/task"))
    awake = {task: thread for task, thread in _thread_states(set(tasks) - python).items() if thread.awake}
    while awake and patience.left > 0:
        pause.wait(THREAD_POLL)
        now = _thread_states(awake)
        awake = {
            task: thread
            for task, thread in awake.items()
            if task in now and now[task].awake and now[task].slept == thread.slept
        }
    return not awake


def _thread_states(tasks: Iterable[int]) -> dict[int, _Thread]:
    """Return the states of these threads, without those that have ended."""
    found: dict[int, _Thread] = {}
    for task in tasks:
        # The kernel writes "stat" in half the time of "status", and it is enough for a thread that sleeps.
        with contextlib.suppress(OSError):  # the thread has ended meanwhile
            awake = _content(f"/proc/self/task/{task}/stat").rpartition(b") ")[2][:1] in (b"R", b"D")
            told = _content(f"/proc/self/task/{task}/status") if awake else b""
            slept = told.partition(b"\nvoluntary_ctxt_switches:")[2].split()
            found[task] = _Thread(awake, int(slept[0]) if slept else 0)
    return found


def _content(file: str) -> bytes:
    opened = os.open(file, os.O_RDONLY)
    try:
        return os.read(opened, 4096)
    finally:
        os.close(opened)
