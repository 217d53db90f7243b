"""Decides when the graph is known: by the answers of all participants, not by the time that has passed.

The real command asks a daemon that has been listening all the time, or waits half a second. There is no daemon here.
The graph is known when

* each participant of this machine has answered a roll call: as many as ports of the domain are in use;
* the endpoints of each have begun to come, and every endpoint's node has a name, or goes on having none;
* a whole further roll call has brought nothing new. A participant answers what came first first, so its answer
  says that it has read whatever was asked before; on a busy machine a roll call takes as long as that does.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from environment.ros2_command.ports import Ports, domain_id, only_this_machine, ports_in_use
from environment.ros2_command.roll_call import RollCall

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

# All in seconds.
_POLL = 0.005
_ROUND = (
    0.06  # a roll call takes at least this long: an idle machine needs less, and endpoints come in a burst
)
_CALL_AGAIN = 0.3  # for those that were still being made
_OTHER_MACHINES = 0.4  # where other machines may answer, wait at least this long for them
_WITHOUT_TABLES = 0.5  # if the participants are unknown: the real command's own wait without a daemon
PATIENCE = 15.0
"""Seconds after which a participant that does not answer is given up, with a warning."""

# rmw_dds_common: every participant of ROS tells and hears the names of nodes here.
_PARTICIPANTS_TOPIC = "ros_discovery_info"
_GUID_PREFIX = 12  # bytes of an endpoint's GID that name its participant
_UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# A node of rclpy 7.1 that was destroyed leaves this service behind as long as its context lives (it is made past the
# node's own services, rclpy/type_description_service.py), and no name is told for it any more.
_LEFT_BEHIND = "/get_type_description"
_NAMELESS = 40
"""Rounds without any change after which an endpoint without a name is taken to have none.

rmw forgets whose endpoints are whose when one of two nodes of the same name is destroyed.
"""


@dataclass(frozen=True)
class Graph:
    """The graph as it is known at one moment.

    Attributes:
        met: The participants of ROS of which writers and readers are known, by their GUID prefixes.
        named: Whether the node of every endpoint has a name.
        content: All that is known.
    """

    met: frozenset[bytes]
    named: bool
    content: object


def look(node: Node) -> Graph:
    """Return what a node knows of the graph now."""
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
    """Return when the graph is settled; how many participants of this machine have not been met by then.

    Args:
        look: returns what is known now.
        roll_call: asks the participants of this machine.
        ports: returns the ports in use now, None if unknown.
        shortest: seconds to wait at the least.
        longest: seconds after which to give up those who do not answer.
        clock: the present time in seconds.
        sleep: waits for a number of seconds.
    """
    start = clock()
    before: Graph | None = None
    unchanged = 0
    while True:
        # One round. Looks are not cheap where many notebooks are open: one a round.
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
    """Wait until a node knows the graph; return how many participants of this machine it could not meet.

    Args:
        node: looks at the graph.
        spin_time: seconds to listen at least; by default as long as other machines may need to answer.
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
    """Return how many seconds to listen, by whether it is known who is on this machine."""
    if not known:
        return _WITHOUT_TABLES
    return 0.0 if only_this_machine() else _OTHER_MACHINES
