"""The judge's own node, which has its own ROS context and is spun by its own thread."""

from __future__ import annotations

import secrets
import threading
from typing import TYPE_CHECKING, Any

from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from autograder.judge.bench.patience import Patience
from autograder.judge.bench.receiving_threads import await_turns
from autograder.ros_participant import receivers_wait

if TYPE_CHECKING:
    from collections.abc import Callable

InvalidHandle = rclpy_implementation.InvalidHandle
"""The errors that rclpy raises if an entity is destroyed while another thread uses it."""


TAKEN_IN = 5.0
"""Time limit in seconds for the judge to process what was sent to it."""
TURN = 0.05
"""Seconds between two checks whether the spinning thread still runs."""


class JudgeFailed(RuntimeError):
    """A callback of the judge itself raised an exception, so the subject could not be checked."""


class _QuietNode(Node):
    """A node whose endpoints report only the QoS events that were requested.

    By default, rclpy gives each endpoint two events that only log a warning. They would cost time, because the executor
    checks all events in each round, and a check in simulated time has some hundred rounds.
    """

    def create_publisher(self, *arguments: Any, **options: Any) -> Any:
        options.setdefault("event_callbacks", PublisherEventCallbacks(use_default_callbacks=False))
        return super().create_publisher(*arguments, **options)

    def create_subscription(self, *arguments: Any, **options: Any) -> Any:
        options.setdefault("event_callbacks", SubscriptionEventCallbacks(use_default_callbacks=False))
        return super().create_subscription(*arguments, **options)


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
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.failure: BaseException | None = None
        self._closing, self._closed = threading.Lock(), False
        self._thread = threading.Thread(target=self._spin, name="judge wire", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while True:
            try:
                self.executor.spin()
            except InvalidHandle:
                continue  # a part has ended and destroyed an entity that was in use
            except ExternalShutdownException:
                return
            except (
                BaseException
            ) as error:  # raised by the judge's own callback: no later result can be trusted
                self.failure = error
            return

    def take_in(self, written_down: Callable[[], int]) -> bool:
        """Wait until everything that had been sent to the judge is recorded. Return True if this succeeds in time.

        This must not be called from a callback of the judge.

        Args:
            written_down: Returns the number of events recorded so far.
        """
        patience = Patience(TAKEN_IN)
        if not await_turns(patience):
            return False
        before = -1
        while before != written_down():
            before = written_down()
            # The time is limited, because a process that a subject left behind may go on sending forever.
            if patience.left <= 0 or not self._take_one_of_each(patience):
                return False
        return True

    def _take_one_of_each(self, patience: Patience) -> bool:
        """Let the executor take at most one message from each endpoint. Return False if the time is up first.

        For this, two tasks are given to the executor, one after the other. An executor begins each round with its tasks
        and then takes what has arrived (rclpy/executors.py, _wait_for_ready_callbacks), so between two tasks there is
        one whole round.
        """
        for _ in range(2):
            done = threading.Event()
            with self._closing:
                if self._closed:
                    return False
                self.executor.create_task(done.set)
            while not done.wait(TURN):
                if patience.left <= 0 or not self._thread.is_alive():
                    return False
        return True

    def close(self) -> None:
        """Stop spinning, join the thread and leave the domain. An unjoined thread would later abort the interpreter."""
        with self._closing:  # Wait: another thread may be in take_in.
            self._closed = True
        self.executor.shutdown(timeout_sec=1.0)
        self._thread.join(timeout=2.0)
        self.node.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()

    def __enter__(self) -> Wire:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
