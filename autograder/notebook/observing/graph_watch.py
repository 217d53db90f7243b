"""The picture of the running graph, kept up to date for a while."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from autograder.notebook.observing.graph_picture import GraphPicture, draw_graph
from autograder.notebook.observing.live_picture import LivePicture
from autograder.notebook.observing.ros_graph import look
from autograder.notebook.observing.topic_traffic import TopicTraffic

if TYPE_CHECKING:
    from rclpy.node import Node

PERIOD = 1.0
"""Seconds between two looks at the graph."""
AGAIN = 10.0
"""Seconds after which a picture with traffic is shown again: its lines flow only a little longer than that by
themselves, so that nothing flows in a picture whose kernel has gone."""


def watch_graph(minutes: float = 10.0) -> LivePicture:
    """Show the running graph below this cell, and draw it again as nodes come and go.

    Lines with traffic flow, and each topic carries its rate. The watch ends by itself after a while, when the cell is
    run again, when another watch begins, when everything is stopped or ROS is shut down; its last picture stays. To
    count, it subscribes to the topics with a node of a hidden name: ``ros2 topic info`` counts one subscription more
    meanwhile.

    Args:
        minutes: How long it goes on at most.

    Raises:
        ValueError: ``minutes`` is not a positive number.
    """
    watch = LivePicture(_GraphPictures(), minutes)
    watch.start()
    return watch


class _GraphPictures:
    def __init__(self) -> None:
        self.name = "_graph_watch"
        self.period = PERIOD
        self._traffic: TopicTraffic | None = None
        self._shown_at = time.monotonic()

    def first(self) -> GraphPicture:
        self._shown = draw_graph()
        return self._shown

    def next(self, node: Node) -> GraphPicture | None:
        self._traffic = self._traffic or TopicTraffic(node)
        graph = look(node)
        picture = GraphPicture(graph, self._traffic.look(graph.channels))
        old = picture.is_moving and time.monotonic() > self._shown_at + AGAIN
        if picture == self._shown and not old:
            return None
        self._shown, self._shown_at = picture, time.monotonic()
        return picture

    def last(self) -> GraphPicture | None:
        """Nothing flows in a picture that is no longer kept up to date."""
        return GraphPicture(self._shown.graph) if self._shown.is_moving else None
