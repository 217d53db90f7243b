"""A new ROS context for each check: on the judge's domain, and rclpy's default context while the check runs.

A student's class calls ``super().__init__("talker_node")``, which uses the default context. While a check runs, the
default is the check's own context. So nodes of the notebook's demonstrations do not disturb the check, and are not
disturbed by it.
"""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Self

import rclpy
import rclpy.utilities
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from autograder.notebook.nodes.background import destroy_nodes_on
from autograder.ros_domain import DOMAIN_VARIABLE
from autograder.ros_participant import UNNAMED, receivers_wait

if TYPE_CHECKING:
    from collections.abc import Sequence

    Endpoint = Sequence[str]
    """An endpoint as the judge names it: its topic in the middleware, and the identifier of its reader or writer."""

_GLOBAL_EXECUTOR = "__executor"
"""The name of the global executor in ``rclpy/__init__.py``."""
MEETING = 0.5
"""Seconds of wall time for which a run waits for its participant to discover the judge. After that it begins anyway."""
MEETING_POLL = 0.002
"""Seconds between two tests whether the judge has been discovered."""


class CheckContext:
    """Replaces rclpy's default context inside a ``with`` block.

    Args:
        domain_id: The judge's domain.
        keeper: The name of the node that keeps the check's participant alive; the judge knows it. It begins with an
            underscore, so that ``ros2 node list`` hides it.
    """

    def __init__(self, domain_id: int, keeper: str) -> None:
        self._domain_id = domain_id
        self._name = keeper
        self._usual: Context | None = None
        self._keeper: Node | None = None
        self.context = Context()

    def __enter__(self) -> Self:
        with rclpy.utilities.g_context_lock:
            self._usual = rclpy.utilities.g_default_context
        # rclpy.spin and similar functions share one executor, which belongs to the context that was first used.
        self._usual_executor = getattr(rclpy, _GLOBAL_EXECUTOR, None)
        setattr(rclpy, _GLOBAL_EXECUTOR, None)
        # Processes that the subject starts, such as the ros2 command, must be on the judge's domain, too.
        self._usual_domain = os.environ.get(DOMAIN_VARIABLE)
        os.environ[DOMAIN_VARIABLE] = str(self._domain_id)
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        setattr(rclpy, _GLOBAL_EXECUTOR, self._usual_executor)
        self._put(self._usual)
        if self._usual_domain is None:
            os.environ.pop(DOMAIN_VARIABLE, None)
        else:
            os.environ[DOMAIN_VARIABLE] = self._usual_domain

    def ensure(self, *, fresh: bool) -> None:
        """Make a new context if ``fresh`` is true, or if the student's code has shut down the last one."""
        if fresh or not self.context.ok():
            self.renew()
        else:
            self._put(self.context)

    def renew(self) -> None:
        """Start a new participant, and let it discover the judge.

        A participant exists as long as it has a node (rmw_fastrtps). Two participants need a fifth of a second to
        discover each other's existing endpoints, but hardly a millisecond for later ones. So a node that does nothing
        is made before the subject, and kept during all runs.
        """
        self._end()
        self.context = Context()
        rclpy.init(
            args=["--ros-args", "--disable-external-lib-logs"],
            context=self.context,
            domain_id=self._domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._put(self.context)
        with receivers_wait():
            self._keeper = Node(
                self._name,
                context=self.context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        deadline = time.monotonic() + MEETING
        while len(self._keeper.get_node_names()) < 2 and time.monotonic() < deadline:
            time.sleep(MEETING_POLL)

    def sees(self, there: Sequence[Endpoint], gone: Sequence[Endpoint], within: float) -> bool:
        """Wait until this participant sees all endpoints of ``there`` and none of ``gone``. Return True if it does.

        An endpoint and its node are announced separately. For endpoints of ``there``, both must be known.

        Args:
            there: Endpoints that are on the graph.
            gone: Endpoints that have been removed.
            within: The limit in seconds of wall time.
        """
        deadline = time.monotonic() + within
        while True:
            known = self._known({topic for topic, _ in [*there, *gone]})
            with_its_node = {end for end, node in known.items() if not node.startswith(UNNAMED)}
            if with_its_node.issuperset(map(tuple, there)) and known.keys().isdisjoint(map(tuple, gone)):
                return True
            if time.monotonic() > deadline:
                return False
            time.sleep(MEETING_POLL)

    def _known(self, topics: set[str]) -> dict[tuple[str, ...], str]:
        """Return the endpoints on these topics, each with the name of its node."""
        node = self._keeper
        assert node is not None
        return {
            (topic, bytes(info.endpoint_gid).hex()): info.node_name
            for topic in topics
            for infos in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
            for info in infos(topic, no_mangle=True)
        }

    def _end(self) -> None:
        """Destroy the nodes of the context, then the context.

        A node that outlives its context would keep the logger of its name. A later node with that name would then log
        to a destroyed publisher ("Failed to publish log message to rosout").
        """
        keeper, self._keeper = self._keeper, None
        if keeper is not None:
            destroy_nodes_on(self.context)
        self.context.try_shutdown()

    @staticmethod
    def _put(context: Context | None) -> None:
        with rclpy.utilities.g_context_lock:
            rclpy.utilities.g_default_context = context  # type: ignore[assignment]
