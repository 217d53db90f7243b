"""Who is on the graph, besides the judge: the public face of a subject.

rclpy has no event for changes of the graph, so these queries are polled; one costs well under a millisecond.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node, NodeNameNonExistentError

RCLError = rclpy_implementation.RCLError

ROLES = ("publisher", "subscription", "service", "client", "action_server", "action_client")

_EVERY_NODE_HAS = frozenset({"/rosout", "/parameter_events", "/clock"})
_EVERY_NODE_SERVES = (
    "/describe_parameters",
    "/get_parameter_types",
    "/get_parameters",
    "/list_parameters",
    "/set_parameters",
    "/set_parameters_atomically",
    "/get_type_description",
)


@dataclass(frozen=True)
class NodeName:
    """A node of the subject's."""

    name: str
    namespace: str

    @property
    def full(self) -> str:
        """Its full name, such as ``/robot/talker``."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


NOT_A_SUBJECT = ("_NODE_", "_check_keeper")
"""How names begin of nodes that are not named yet (rmw_dds_common), and of the one that a notebook's check makes."""

Interface = dict[str, dict[str, str]]
"""Role -> {name: type}; where a name has several types they are joined with a comma."""


def subject_nodes(judge: Node) -> list[NodeName]:
    """Every node on the domain but the judge's, once each name."""
    own = judge.get_name()
    seen = {(name, space) for name, space in judge.get_node_names_and_namespaces() if name != own}
    return [NodeName(name, space) for name, space in sorted(seen) if not name.startswith(NOT_A_SUBJECT)]


def survey(judge: Node) -> Interface:
    """The endpoints of all of the subject's nodes, without those that every node has."""
    found: Interface = {role: {} for role in ROLES}
    for node in subject_nodes(judge):
        for role, query in _QUERIES.items():
            for name, types in _ask(query, judge, node):
                if _is_own_work(role, name):
                    _add(found[role], name, types)
    return found


def is_there(judge: Node, role: str, name: str) -> str | None:
    """The type of the subject's endpoint on a topic, told without the names of nodes; None where there is none.

    An endpoint is known before the node that it belongs to: the two are announced separately.
    """
    infos = {
        "publisher": judge.get_publishers_info_by_topic,
        "subscription": judge.get_subscriptions_info_by_topic,
    }.get(role)
    others = [info for info in (infos(name) if infos else []) if info.node_name != judge.get_name()]
    return others[0].topic_type if others else None


def counterparts(judge: Node, heard: list[str], spoken: list[str]) -> list[NodeName]:
    """The subject's nodes at the other end of topics, once their real names are known.

    Args:
        judge: The judge's node.
        heard: Topics that the judge listens to.
        spoken: Topics that the judge speaks on.
    """
    infos = [info for topic in heard for info in judge.get_publishers_info_by_topic(topic)]
    infos += [info for topic in spoken for info in judge.get_subscriptions_info_by_topic(topic)]
    names = [NodeName(info.node_name, info.node_namespace) for info in infos]
    own = judge.get_name()
    return [
        n for n in dict.fromkeys(names) if n.name and n.name != own and not n.name.startswith(NOT_A_SUBJECT)
    ]


def shows(judge: Node, marker: str) -> bool:
    """Whether a node is known to have both a publisher and a subscription of this name.

    Made last, they are known last: each kind of endpoint is announced in order (DDSI-RTPS, 8.5.4).
    """
    return any(
        marker in dict(_ask(Node.get_publisher_names_and_types_by_node, judge, node))
        and marker in dict(_ask(Node.get_subscriber_names_and_types_by_node, judge, node))
        for node in subject_nodes(judge)
    )


_Query = Callable[[Node, str, str], list[tuple[str, list[str]]]]

_QUERIES: dict[str, _Query] = {
    "publisher": Node.get_publisher_names_and_types_by_node,
    "subscription": Node.get_subscriber_names_and_types_by_node,
    "service": Node.get_service_names_and_types_by_node,
    "client": Node.get_client_names_and_types_by_node,
    "action_server": get_action_server_names_and_types_by_node,
    "action_client": get_action_client_names_and_types_by_node,
}


def _ask(query: _Query, judge: Node, node: NodeName) -> list[tuple[str, list[str]]]:
    try:
        return query(judge, node.name, node.namespace)
    except (NodeNameNonExistentError, RCLError):
        return []  # it went away between the two questions


def _is_own_work(role: str, name: str) -> bool:
    if name in _EVERY_NODE_HAS or "/_action/" in name or name.startswith("/_ready"):
        return False
    return not (role in ("service", "client") and name.endswith(_EVERY_NODE_SERVES))


def _add(found: dict[str, str], name: str, types: list[str]) -> None:
    known = set(filter(None, found.get(name, "").split(",")))
    found[name] = ",".join(sorted(known | set(types)))
