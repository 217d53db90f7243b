"""Finds the subject's nodes and endpoints: with queries of the ROS graph, and by announcements of DDS participants.

Every node and endpoint on the ROS graph that is not the judge's counts as the subject's. rclpy has no event for changes
of the graph, so callers repeat the queries. A query takes well under a millisecond.

A DDS participant announces itself when it is created, and rmw_fastrtps creates it together with a process's first node.
The graph shows the node only after several more messages. If a program ends before these messages, its announcement has
still arrived. Participants announce themselves to a multicast group or, if discovery is limited to this machine, to the
ports that the first participants on this machine use (DDSI-RTPS 2.5, 9.6.1).
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node, NodeNameNonExistentError

from autograder.dds_discovery import GROUP_OFFSET, PARTICIPANT_OFFSET, UNNAMED, port
from autograder.judge.bench.qos_profiles import qos_of
from autograder.judge.bench.unreadable import checked, names_are_read

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.counterparts import Qos


RCLError = rclpy_implementation.RCLError

ROLES = ("publisher", "subscription", "service", "client", "action_server", "action_client")

_FAST_DDS = b"\x01\x0f"
"""The vendor id with which identifiers of Fast DDS begin (DDSI-RTPS, vendor ids)."""
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
    """The name and namespace of a node of the subject."""

    name: str
    namespace: str

    @property
    def full(self) -> str:
        """The full name, such as ``/robot/talker``."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


Interface = dict[str, dict[str, str]]
"""Endpoints as role -> {name: type}. If a name has several types, they are joined with a comma."""


def subject_nodes(judge: Node, keeper: str) -> list[NodeName]:
    """Return the names of all nodes on the domain, each once, except the judge's and the keeper's.

    Args:
        keeper: The name of the node with which a notebook's check keeps its participant alive; empty if it has none.
            One node with this name is ignored, but a second node with this name belongs to the subject.
    """
    return sorted(set(every_node(judge, keeper)), key=lambda node: (node.name, node.namespace))


@names_are_read()
def every_node(judge: Node, keeper: str) -> list[NodeName]:
    """Like :func:`subject_nodes`, but with a name for each node, so that a name of two nodes comes twice."""
    own = judge.get_name()
    seen = judge.get_node_names_and_namespaces()
    others = [NodeName(name, space) for name, space in seen if name != own and not name.startswith(UNNAMED)]
    for other in others:
        checked(other.full)
    if keeper and (the_one := NodeName(keeper, "/")) in others:
        others.remove(the_one)
    return others


def survey(judge: Node, ends: list[TopicEnd] | None = None) -> Interface:
    """Return the endpoints of all of the subject's nodes, without those that every node has, such as ``/rosout``.

    The keeper (:func:`subject_nodes`) need not be left out, because it has only endpoints that every node has.

    Args:
        ends: The publishers and subscriptions, if they were queried a moment ago.
    """
    found: Interface = {role: {} for role in ROLES}
    for end in topic_ends(judge) if ends is None else ends:
        _add(found[end.role], end.topic, [end.type_name])
    for node in subject_nodes(judge, keeper=""):
        for role, query in _QUERIES.items():
            for name, types in _ask(query, judge, node):
                if _is_own_work(role, name):
                    _add(found[role], name, types)
    return found


@dataclass(frozen=True)
class TopicEnd:
    """A publisher or a subscription of the subject.

    Attributes:
        role: ``"publisher"`` or ``"subscription"``.
        topic: The full name of the topic.
        type_name: The message type, such as ``"std_msgs/msg/String"``.
        process: The lower 16 bits of the process id; 0 if unknown.
        qos: The QoS.
    """

    role: str
    topic: str
    type_name: str
    process: int
    qos: Qos


@names_are_read()
def topic_ends(judge: Node) -> list[TopicEnd]:
    """Return the subject's publishers and subscriptions.

    The query is by topic, not by node, for two reasons. If two nodes have the same name, a query by node returns the
    endpoints of only one of them. And an endpoint may be discovered before its node, because DDS announces them
    separately.
    """
    own = judge.get_name()
    with judge.handle:
        return [
            TopicEnd(
                role,
                topic,
                end["topic_type"],
                _process(bytes(end["endpoint_gid"])),
                qos_of(end["qos_profile"]),
            )
            for topic, _ in judge.get_topic_names_and_types()
            if _is_own_work("publisher", checked(topic))
            # rclpy's own methods check the name again, and make objects of what is read here: four times the work.
            for role, ends in _ENDS_OF_A_TOPIC.items()
            for end in ends(judge.handle, topic, False)
            if end["node_name"] != own
        ]


def _process(gid: bytes) -> int:
    """Return the lower 16 bits of the process id, which Fast DDS writes into an endpoint's identifier; 0 if unknown."""
    return int.from_bytes(gid[4:6], "little") if gid[:2] == _FAST_DDS else 0


@names_are_read()
def counterparts(judge: Node, heard: list[str], spoken: list[str]) -> list[NodeName] | None:
    """Return the subject's nodes that use these topics; None before the names of all of them are discovered.

    Args:
        heard: The topics to which the judge subscribes.
        spoken: The topics on which the judge publishes.
    """
    infos = [info for topic in heard for info in judge.get_publishers_info_by_topic(topic)]
    infos += [info for topic in spoken for info in judge.get_subscriptions_info_by_topic(topic)]
    names = [NodeName(info.node_name, info.node_namespace) for info in infos]
    own = judge.get_name()
    if any(not one.name or one.name.startswith(UNNAMED) for one in names):
        return None
    return [one for one in dict.fromkeys(names) if one.name != own and checked(one.full)]


def owners(judge: Node, role: str, name: str) -> list[NodeName]:
    """Return the subject's nodes that have an endpoint of this role and name."""
    query = _QUERIES[role]
    return [node for node in subject_nodes(judge, keeper="") if name in dict(_ask(query, judge, node))]


def shows(judge: Node, marker: str) -> bool:
    """Return True if the topic ``marker``, which shows that all endpoints are made, is on the graph.

    The notebook makes a publisher and a subscription on this topic after all other endpoints, and endpoints of one kind
    are announced in order (DDSI-RTPS, 8.5.4). So once both are on the graph, all other endpoints are, too.
    """
    return any(
        marker in dict(_ask(Node.get_publisher_names_and_types_by_node, judge, node))
        and marker in dict(_ask(Node.get_subscriber_names_and_types_by_node, judge, node))
        for node in subject_nodes(judge, keeper="")
    )


_Query = Callable[[Node, str, str], list[tuple[str, list[str]]]]

_QUERIES: dict[str, _Query] = {
    "service": Node.get_service_names_and_types_by_node,
    "client": Node.get_client_names_and_types_by_node,
    "action_server": get_action_server_names_and_types_by_node,
    "action_client": get_action_client_names_and_types_by_node,
}


_ENDS_OF_A_TOPIC = {
    "publisher": rclpy_implementation.rclpy_get_publishers_info_by_topic,
    "subscription": rclpy_implementation.rclpy_get_subscriptions_info_by_topic,
}


@names_are_read()
def _ask(query: _Query, judge: Node, node: NodeName) -> list[tuple[str, list[str]]]:
    try:
        return [(checked(name), types) for name, types in query(judge, node.name, node.namespace)]
    except (NodeNameNonExistentError, RCLError):
        return []  # the node disappeared between the two queries


def _is_own_work(role: str, name: str) -> bool:
    if name in _EVERY_NODE_HAS or "/_action/" in name or name.startswith("/_ready"):
        return False
    return not (role in ("service", "client") and name.endswith(_EVERY_NODE_SERVES))


def _add(found: dict[str, str], name: str, types: list[str]) -> None:
    known = set(filter(None, found.get(name, "").split(",")))
    found[name] = ",".join(sorted(known | set(types)))


Endpoint = tuple[str, str]
"""An endpoint: its topic in the middleware, and the identifier (DDSI-RTPS, 8.2.4.1) of the reader or writer, in
hexadecimal.
"""


def server_endpoints(node: Node, services: Iterable[str]) -> set[Endpoint]:
    """Return the DDS endpoints of the services that this node serves under these names.

    In DDS, a service consists of two endpoints: a reader of requests and a writer of replies (rmw_fastrtps_shared_cpp,
    namespace_prefix.cpp). Both are returned, because a client considers the service ready only when it has discovered
    both.

    Args:
        services: The full names of the services.
    """
    return _endpoints(node, [topic for name in services for topic in (f"rq{name}Request", f"rr{name}Reply")])


def topic_endpoints(node: Node, topics: Iterable[str]) -> set[Endpoint]:
    """Return the DDS endpoints of a node's publishers and subscriptions on these topics."""
    return _endpoints(node, [f"rt{name}" for name in topics])


@names_are_read()
def _endpoints(node: Node, topics: Iterable[str]) -> set[Endpoint]:
    """Return a node's endpoints on these topics, with the identifiers by which all participants know them.

    A topic's name does not identify an endpoint, because the next run may use the name of a removed endpoint again.

    Args:
        topics: The names of the topics in the middleware.
    """
    return {
        (topic, bytes(info.endpoint_gid).hex())
        for topic in topics
        for infos in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
        for info in infos(topic, no_mangle=True)
        if info.node_name == node.get_name()
    }


_GROUP, _LOOPBACK = "239.255.0.1", "127.0.0.1"
_SHARED = (socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
_JOINED = (
    socket.IPPROTO_IP,
    socket.IP_ADD_MEMBERSHIP,
    socket.inet_aton(_GROUP) + socket.inet_aton(_LOOPBACK),
)
_PARTICIPANT_INDEX = 31
"""The judge listens on the port of the participant with this index. Fast DDS announces to indexes 0 to 31
(rmw_fastrtps, participant.cpp), and a new participant takes the lowest free index, so this port is usually free.
"""
_RTPS = b"RTPS"
_PROCESS_ID = slice(8, 16)
"""The bytes of a message's header that identify the sending process (DDSI-RTPS 2.5, 8.3.3.1). The rest of the
identifier counts the participants of a process.
"""
_LARGEST_MESSAGE = 65_536
MAX_PROCESSES = 1_000
"""The maximum number of processes to remember, and of messages to read at once. It is limited so that a flood of
messages neither fills the memory nor keeps the judge from other work.
"""


class Announcements:
    """Listens for announcements of DDS participants, on two sockets. A socket that cannot be opened is left out."""

    def __init__(self, domain_id: int) -> None:
        self._heard: set[bytes] = set()
        self._lock = threading.Lock()
        self._selector = selectors.DefaultSelector()
        self._ended, self._end = socket.socketpair()
        self._selector.register(self._ended, selectors.EVENT_READ)
        group = _listening("", port(domain_id, GROUP_OFFSET), _SHARED, _JOINED)
        place = _listening(_LOOPBACK, port(domain_id, PARTICIPANT_OFFSET + 2 * _PARTICIPANT_INDEX))
        self._sockets = [listening for listening in (group, place) if listening is not None]
        for listening in self._sockets:
            self._selector.register(listening, selectors.EVENT_READ)
        self._thread = threading.Thread(target=self._listen, name="announcements", daemon=True)
        self._thread.start()

    def heard(self) -> frozenset[bytes]:
        """Return the DDS ids of the processes that have announced a participant so far."""
        with self._lock:
            self._take()
            return frozenset(self._heard)

    def close(self) -> None:
        self._end.close()
        self._thread.join()
        self._selector.close()
        for opened in (self._ended, *self._sockets):
            opened.close()

    def _listen(self) -> None:
        """Read messages continuously, so that the sockets do not fill up."""
        while not any(key.fileobj is self._ended for key, _ in self._selector.select()):
            with self._lock:
                self._take()

    def _take(self) -> None:
        for listening in self._sockets:
            for message in _waiting(listening):
                if message.startswith(_RTPS) and len(self._heard) < MAX_PROCESSES:
                    self._heard.add(message[_PROCESS_ID])


@names_are_read()
def process_of(node: Node) -> bytes:
    """Return the DDS id of the process that made a node.

    The id is part of the identifier of the node's subscription to ``/rosout``. Without this subscription, the result is
    empty.
    """
    infos = node.get_subscriptions_info_by_topic("/rosout")
    own = (bytes(info.endpoint_gid) for info in infos if info.node_name == node.get_name())
    return next((identifier[: _PROCESS_ID.stop - _PROCESS_ID.start] for identifier in own), b"")


def _waiting(listening: socket.socket) -> Iterator[bytes]:
    with contextlib.suppress(OSError):
        for _ in range(MAX_PROCESSES):
            yield listening.recv(_LARGEST_MESSAGE)


def _listening(address: str, udp_port: int, *options: tuple[int, int, int | bytes]) -> socket.socket | None:
    """Return a UDP socket that listens on this address and port; None if it cannot be opened."""
    listening = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        for option in options:
            listening.setsockopt(*option)
        listening.bind((address, udp_port))
    except OSError:
        listening.close()
        return None
    listening.setblocking(False)
    return listening
