"""Detects that a process has made a node, even if the process ends before the ROS graph shows the node.

A DDS participant announces itself when it is created, and rmw_fastrtps creates it together with a process's first node.
The graph shows the node only after several more messages. If a program ends before these messages, its announcement has
still arrived at the sockets of this module.

Participants announce themselves to a multicast group or, if discovery is limited to this machine, to the ports that the
first participants on this machine use (DDSI-RTPS 2.5, 9.6.1).
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
from typing import TYPE_CHECKING

from autograder.ros_domain import GROUP_OFFSET, PARTICIPANT_OFFSET, port

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.node import Node

_GROUP, _LOOPBACK = "239.255.0.1", "127.0.0.1"
_SHARED = (socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
_JOINED = (
    socket.IPPROTO_IP,
    socket.IP_ADD_MEMBERSHIP,
    socket.inet_aton(_GROUP) + socket.inet_aton(_LOOPBACK),
)
_PLACE = 31
"""The judge listens on the port of the participant with this index. Fast DDS announces to indexes 0 to 31
(rmw_fastrtps, participant.cpp), and a new participant takes the lowest free index, so this port is usually free.
"""
_RTPS = b"RTPS"
_PREFIX = slice(8, 16)
"""The bytes of a message's header that identify the sending process (DDSI-RTPS 2.5, 8.3.3.1). The rest of the
identifier counts the participants of a process.
"""
_LARGEST = 65_536
MOST = 1_000
"""The maximum number of processes to remember, and of messages to read at once. It is limited so that a flood of
messages neither fills the memory nor keeps the judge from other work.
"""


class Announcements:
    """Listens for the announcements of DDS participants, on two sockets. A socket that cannot be opened is left out.

    Args:
        domain_id: The ROS domain.
    """

    def __init__(self, domain_id: int) -> None:
        self._heard: set[bytes] = set()
        self._lock = threading.Lock()
        self._selector = selectors.DefaultSelector()
        self._ended, self._end = socket.socketpair()
        self._selector.register(self._ended, selectors.EVENT_READ)
        group = _listening("", port(domain_id, GROUP_OFFSET), _SHARED, _JOINED)
        place = _listening(_LOOPBACK, port(domain_id, PARTICIPANT_OFFSET + 2 * _PLACE))
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
        """Stop listening."""
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
                if message.startswith(_RTPS) and len(self._heard) < MOST:
                    self._heard.add(message[_PREFIX])


def process_of(node: Node) -> bytes:
    """Return the DDS id of the process that made a node.

    The id is part of the identifier of the node's subscription to ``/rosout``. Without this subscription, the result is
    empty.
    """
    infos = node.get_subscriptions_info_by_topic("/rosout")
    own = (bytes(info.endpoint_gid) for info in infos if info.node_name == node.get_name())
    return next((identifier[: _PREFIX.stop - _PREFIX.start] for identifier in own), b"")


def _waiting(listening: socket.socket) -> Iterator[bytes]:
    with contextlib.suppress(OSError):
        for _ in range(MOST):
            yield listening.recv(_LARGEST)


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
