"""The judge's own services and actions, by the identifiers under which every participant of the domain knows it.

Names do not tell one server from the next: the one of an earlier run is taken away, and its name comes again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rclpy.node import Node

Endpoint = tuple[str, str]
"""A topic of the middleware, and the identifier (DDSI-RTPS, 8.2.4.1) of a reader or writer on it, as hexadecimal."""


def endpoints(node: Node, services: Iterable[str]) -> set[Endpoint]:
    """The endpoints of a node's servers.

    A service is a reader of requests and a writer of replies (rmw_fastrtps_shared_cpp, namespace_prefix.cpp), and a
    client takes it for ready when it knows both.

    Args:
        node: Whose servers.
        services: Their full names.
    """
    found: set[Endpoint] = set()
    for name in services:
        requests, replies = f"rq{name}Request", f"rr{name}Reply"
        known = (
            (requests, node.get_subscriptions_info_by_topic(requests, no_mangle=True)),
            (replies, node.get_publishers_info_by_topic(replies, no_mangle=True)),
        )
        found |= {
            (topic, bytes(info.endpoint_gid).hex())
            for topic, infos in known
            for info in infos
            if info.node_name == node.get_name()
        }
    return found
