"""Wait until the graph is known: for everybody on this machine, and no longer.

The real command asks a daemon that has been listening all the time, or waits half a second. Here there is no
daemon. What there is to find on this machine is known beforehand, though: each DDS participant holds a UDP
port of its domain, so the wait ends when that many have been met, their nodes have names, and nothing more
has come for a moment.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.node import Node

# Ports of RTPS (OMG DDSI-RTPS 2.2, 9.6.1): a domain has 250 of them, and the discovery port of its n-th
# participant on a machine is number 10 + 2n.
_BASE, _PER_DOMAIN, _FIRST_UNICAST = 7400, 250, 10
_SOCKET_TABLES = ("/proc/net/udp", "/proc/net/udp6")

# All in seconds.
_POLL = 0.005
_QUIET = 0.04  # nothing new for this long: an endpoint's announcements come in one burst
_OTHER_MACHINES = 0.4  # where other machines may answer, wait at least this long for them
# A participant that has not been met soon has missed the answers to its first announcement, and a new one is
# met sooner than the next announcement comes. In the end wait for that: it comes every 3 s.
PATIENCE = (0.3, 0.4, 3.2)

_UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# rmw_dds_common: every participant of ROS publishes the names of its nodes here.
_PARTICIPANTS_TOPIC = "ros_discovery_info"
_GUID_PREFIX = 12  # bytes of an endpoint's GID that name its participant


@dataclass(frozen=True)
class Graph:
    """What is known at one moment: the participants met, whether all have told names, and all there is."""

    participants: int
    named: bool
    content: object


def domain_id() -> int:
    """Return ROS_DOMAIN_ID, 0 when unset.

    Raises:
        RuntimeError: it is not a number from 0 to 232.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "").strip()
    if not text:
        return 0
    if not text.isdecimal() or int(text) > 232:
        raise RuntimeError(
            f"ROS_DOMAIN_ID is '{text}': it must be a number from 0 to 232 (101 or less is safe)"
        )
    return int(text)


def only_this_machine() -> bool:
    """Tell whether ROS_AUTOMATIC_DISCOVERY_RANGE keeps discovery on this machine."""
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() in {"LOCALHOST", "OFF"}


def ports_in_use(tables: Iterable[str] = _SOCKET_TABLES) -> set[int] | None:
    """Return the UDP ports that are bound on this machine, or None where Linux's tables are missing."""
    ports: set[int] = set()
    seen = False
    for table in tables:
        try:
            lines = Path(table).read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        seen = True
        ports.update(int(line.split()[1].rpartition(":")[2], 16) for line in lines)
    return ports if seen else None


def participants_here(domain: int, ports: set[int] | None) -> int | None:
    """Return how many DDS participants of a domain hold a port of this machine (None: not known)."""
    if ports is None:
        return None
    start = _BASE + _PER_DOMAIN * domain
    return sum(port in ports for port in range(start + _FIRST_UNICAST, start + _PER_DOMAIN, 2))


def look(node: Node) -> Graph:
    """Return what a node knows of the graph now."""
    met = {
        bytes(info.endpoint_gid)[:_GUID_PREFIX]
        for info in node.get_publishers_info_by_topic(_PARTICIPANTS_TOPIC, no_mangle=True)
    }
    topics = tuple(sorted((name, *types) for name, types in node.get_topic_names_and_types()))
    endpoints = [
        (name, info.node_name, bytes(info.endpoint_gid))
        for name, *_ in topics
        for ask in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
        for info in ask(name)
    ]
    names = tuple(sorted(node.get_node_names_and_namespaces()))
    named = all(name != _UNKNOWN_NODE for _, name, _ in endpoints)
    return Graph(len(met), named, (topics, names, tuple(sorted(endpoints))))


def wait_until_known(
    observe: Callable[[], Graph],
    expected: int | None,
    shortest: float,
    *,
    names: bool = True,
    longest: float,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> bool:
    """Return when the graph is known, and whether everybody who was expected has been met.

    Args:
        observe: returns what is known now.
        expected: the number of participants to meet, oneself included; None when it can not be told.
        shortest: seconds to wait at the least.
        names: wait for the names of the nodes too, which come 0.1 to 0.3 s after their endpoints.
        longest: seconds after which to give up meeting those who are missing.
        clock: the present time in seconds.
        sleep: waits for a number of seconds.
    """
    start = changed = clock()
    last: Graph | None = None
    met = False
    while (now := clock()) - start < max(shortest, PATIENCE[-1] if met else longest):
        graph = observe()
        if graph != last:
            last, changed = graph, now
        met = expected is None or graph.participants >= expected
        told = graph.named or not names
        if met and told and now - start >= shortest and now - changed >= _QUIET:
            break
        sleep(_POLL)
    return met


def shortest_wait(spin_time: float | None, expected: int | None) -> float:
    """Return how many seconds to listen at least: as asked, or as long as others may need to answer."""
    if spin_time is not None:
        return spin_time
    if expected is None:
        return 0.5  # the real command's own wait without a daemon
    return 0.0 if only_this_machine() else _OTHER_MACHINES
