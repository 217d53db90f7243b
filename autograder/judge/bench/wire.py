"""The judge's own node, in a ROS context of its own, spun by a thread of its own."""

from __future__ import annotations

import secrets
import threading
from typing import Any

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from autograder.ros_participant import receivers_wait

InvalidHandle = rclpy_implementation.InvalidHandle
"""What rclpy raises about an entity that was destroyed meanwhile."""


class JudgeFailed(RuntimeError):
    """A callback of the judge's raised: the subject could not be checked."""


class Wire:
    """One participant on one domain. Made fresh for each part: a fresh participant is met at once.

    Attributes:
        node: The judge's node; it has no parameter services and no log topic, so that it adds next to nothing
            to the graph.
        executor: Spins the node in a thread of its own.
        failure: What ended that thread, where it was an error of the judge's own.
    """

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        self.context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        with receivers_wait():
            self.node = Node(
                f"judge_{secrets.token_hex(4)}",
                context=self.context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.failure: BaseException | None = None
        self._thread = threading.Thread(target=self._spin, name="judge wire", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while True:
            try:
                self.executor.spin()
            except InvalidHandle:
                continue  # a part has ended and taken something away that was just being used
            except ExternalShutdownException:
                return
            except BaseException as error:  # a callback of the judge's own: nothing after it can be trusted
                self.failure = error
            return

    def close(self) -> None:
        """Stop spinning, join the thread and leave the domain. An unjoined thread aborts the interpreter."""
        self.executor.shutdown(timeout_sec=1.0)
        self._thread.join(timeout=2.0)
        self.node.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()

    def __enter__(self) -> Wire:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
