"""Tests whether this machine still delivers messages, so that no right answer fails because its messages are lost.

The kernel limits the memory of all sockets of a machine, and the number of epoll watches of each user, sandboxes
included. If either is used up, a node still starts without an error, but it receives little or nothing (udp(7),
epoll(7)).
"""

from __future__ import annotations

import select
import socket

from autograder.judge.bench.wire import JudgeFailed

NOT_DELIVERED = (
    "This machine delivers no messages at the moment, because other programs fill the memory of its sockets. So the "
    "judge cannot tell whether your node sent any. Close some programs, or wait a little, and check again."
)
_DATAGRAMS, _BYTES = 16, 4096
"""The number of datagrams to send, and the bytes in each. Together they are less than half of what a socket normally
holds, but more than a socket holds if other programs have used up the system's memory for sockets.
"""
_ARRIVES_WITHIN = 10.0
"""Time limit in seconds of wall time for a datagram to arrive. Only a busy processor can delay a datagram so long."""


class NotDelivered(JudgeFailed):
    """There is no verdict: the subject did not pass, but perhaps only because this machine lost messages."""


def delivers() -> bool:
    """Return True if datagrams that this process sends to itself arrive, and epoll reports them."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end, select.epoll() as watch:
            end.bind(("127.0.0.1", 0))
            watch.register(end, select.EPOLLIN)
            for _ in range(_DATAGRAMS):
                end.sendto(bytes(_BYTES), end.getsockname())
            for _ in range(_DATAGRAMS):
                if not watch.poll(_ARRIVES_WITHIN):
                    return False
                end.recv(_BYTES)
    except OSError:
        return False
    return True
