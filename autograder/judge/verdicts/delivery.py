"""The machine's share in silence: whether what is sent still arrives here, and whether who waits for it is told.

What waits in sockets is counted for the whole machine, and how much may be watched for each user, all boxes included.
Where others have used either up, a node is made without an error and hears little or nothing (udp(7), epoll(7)).
"""

from __future__ import annotations

import select
import socket

from autograder.judge.bench.wire import JudgeFailed

NOT_DELIVERED = (
    "This machine delivers no more messages at the moment, since other programs fill the memory of its sockets, so the "
    "judge cannot tell whether your node sent any. Close some, or wait a little, and check again."
)
_DATAGRAMS, _BYTES = 16, 4096
"""More than a socket gets where this memory is used up, and less than half of what it has room for elsewhere."""
_ARRIVES_WITHIN = 10.0
"""Seconds of wall time; on its way within a machine a datagram waits for nothing but a processor."""


class NotDelivered(JudgeFailed):
    """The subject did not pass, and that may be because this machine lost its messages."""


def delivers() -> bool:
    """True if datagrams that this process sends to itself arrive, and it is told of them."""
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
