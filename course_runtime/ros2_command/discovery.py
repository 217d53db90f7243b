"""Decides when the ROS graph is completely known: by the answers of all participants, and not by the elapsed time.

The real command asks a daemon that has been listening all the time, or waits half a second. Here there is no daemon.
The graph counts as known when

* each participant of this machine has answered a roll call; their number is that of the domain's ports in use;
* the endpoints of each participant have begun to arrive, and the node of every endpoint has a name or is known to
  have none;
* one more roll call has brought nothing new. A participant answers requests in order, so its answer shows that it has
  read all earlier ones. On a busy machine a roll call takes as long as that needs.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_runtime.ros2_command.ports import Ports, domain_id, only_this_machine, ports_in_use
from course_runtime.ros2_command.roll_call import RollCall

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

# All of these are in seconds.
_POLL = 0.005
_ROUND = 0.06  # the minimum for a roll call: an idle machine needs less, and endpoints come in a burst
_CALL_AGAIN = 0.3  # call again after this time, for participants that were still being made
_OTHER_MACHINES = 0.4  # the minimum wait if other machines may answer
_WITHOUT_TABLES = 0.5  # the wait if the participants are unknown: that of the real command without a daemon
PATIENCE = 15.0
"""Seconds after which a participant that does not answer is given up, with a warning."""

# The topic on which all ROS participants announce and receive the names of nodes (rmw_dds_common).
_PARTICIPANTS_TOPIC = "ros_discovery_info"
_GUID_PREFIX = 12  # the number of bytes of an endpoint's GUID that identify its participant
_UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# A destroyed node of rclpy 7.1 leaves this service on the graph as long as its context exists
# (rclpy/type_description_service.py does not make it through the node). No name is announced for it any more.
_LEFT_BEHIND = "/get_type_description"
_NAMELESS = 40
"""The number of rounds without a change after which an endpoint without a node name counts as nameless.

If two nodes have the same name and one is destroyed, rmw no longer knows to which node an endpoint belongs.
"""


@dataclass(frozen=True)
class Graph:
    """The ROS graph as it is known at one moment.

    Attributes:
        met: The GUID prefixes of the ROS participants whose writers and readers are known.
        named: True if the node of every endpoint has a name.
        content: Everything that is known.
    """

    met: frozenset[bytes]
    named: bool
    content: object


def look(node: Node) -> Graph:
    """Return what a node knows about the graph now."""
    names = [name for name, _ in node.get_topic_names_and_types(no_demangle=True)]
    publishers, subscriptions = (
        {name: ask(name, no_mangle=True) for name in names}
        for ask in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
    )
    told, heard = (
        {bytes(info.endpoint_gid)[:_GUID_PREFIX] for info in side.get(_PARTICIPANTS_TOPIC, ())}
        for side in (publishers, subscriptions)
    )
    infos = [
        info
        for side in (publishers, subscriptions)
        for name in names
        if name != _PARTICIPANTS_TOPIC and _LEFT_BEHIND not in name
        for info in side[name]
    ]
    endpoints = frozenset((info.node_namespace, info.node_name, bytes(info.endpoint_gid)) for info in infos)
    nodes = tuple(sorted(node.get_node_names_and_namespaces()))
    named = all(name != _UNKNOWN_NODE for _, name, _ in endpoints)
    return Graph(frozenset(told & heard), named, (told, heard, endpoints, nodes))


def wait_until_settled(
    look: Callable[[], Graph],
    roll_call: RollCall,
    ports: Callable[[], Ports | None],
    shortest: float,
    *,
    longest: float = PATIENCE,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> int:
    """Wait until the graph is settled. Return the number of this machine's participants that are then still unknown.

    Args:
        look: Returns what is known now.
        roll_call: Asks the participants of this machine.
        ports: Returns the ports in use now; None if unknown.
        shortest: The minimum number of seconds to wait.
        longest: Seconds after which participants that do not answer are given up.
        clock: Returns the current time in seconds.
        sleep: Waits for a number of seconds.
    """
    start = clock()
    before: Graph | None = None
    unchanged = 0
    while True:
        # This is one round. A query is slow if many notebooks are open, so each round has only one.
        called, here = clock(), ports()
        roll_call.call(here.others if here else ())
        while True:
            sleep(_POLL)
            roll_call.listen(here.own if here else ())
            now = clock()
            heard = len(roll_call.answered) + len(roll_call.strangers)
            missing = max(0, len(here.others) - heard) if here else 0
            if now - called >= (_CALL_AGAIN if missing else _ROUND):
                break
        graph = look()
        unmet = roll_call.answered - graph.met
        unchanged = unchanged + 1 if graph == before else 0
        known = not missing and not unmet and (graph.named or unchanged >= _NAMELESS)
        if known and unchanged and now - start >= shortest:
            return 0
        if now - start >= max(shortest, longest):
            return missing + len(unmet)
        before = graph


def discover(node: Node, spin_time: float | None) -> int:
    """Wait until a node knows the graph. Return the number of this machine's participants that did not answer.

    Args:
        node: The node that queries the graph.
        spin_time: The minimum number of seconds to listen; by default as long as other machines may need to answer.
    """
    domain = domain_id()
    if spin_time is None:
        spin_time = _least_wait(known=ports_in_use(domain) is not None)
    roll_call = RollCall()
    try:
        return wait_until_settled(lambda: look(node), roll_call, lambda: ports_in_use(domain), spin_time)
    finally:
        roll_call.close()


def _least_wait(*, known: bool) -> float:
    """Return the minimum seconds to listen, which depends on whether this machine's participants are known."""
    if not known:
        return _WITHOUT_TABLES
    return 0.0 if only_this_machine() else _OTHER_MACHINES
