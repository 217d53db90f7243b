"""Asks every DDS participant of this machine who it is, and passes the answers to a participant of this process.

Fast DDS (2.14) announces a new participant before it has registered who receives. A participant that was
there already answers at once, and once only: an answer that is read too early is lost, and the next chance
comes with the periodic announcement, up to 3 s later (RTPSParticipantImpl::enable, PDPStatelessWriter). Of
seven participants on an idle machine one or two were met that late, more on a busy one.

A participant answers each participant that is new to it. So a new participant is announced here, under a unique GUID.
It has no endpoints, and a plain socket that is open before the question is sent; at the end it is withdrawn. The
answers are announcements in their wire format, and they are passed on to this process's own participant, which missed
them. A participant that does not answer, because it was still being made, is asked again.

The bytes are those of RTPS (OMG DDSI-RTPS 2.3): 8.3.3 and 9.4.5 for messages, 9.6.2 for parameters.
"""

from __future__ import annotations

import contextlib
import os
import socket
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

LOOPBACK = "127.0.0.1"
_PREFIX = 12  # the number of bytes of a GUID that identify its participant
_HEADER = 20  # the number of bytes of a message before its first submessage
_LONGEST = 65536  # the maximum number of bytes of a datagram
_LEASE = 10  # seconds after which participants forget an announced one that was not withdrawn

_VENDOR = b"\x01\x0f"
_VERSION = b"\x02\x03"
_MAGIC = b"RTPS"
_DATA = 0x15
_LITTLE_ENDIAN, _INLINE_QOS, _PAYLOAD = 0x01, 0x02, 0x04
_PARTICIPANT = b"\x00\x00\x01\xc1"
_ANNOUNCER, _DETECTOR = b"\x00\x01\x00\xc2", b"\x00\x01\x00\xc7"
# The announced participant has only these endpoints, so others send it no data about endpoints.
_ANNOUNCER_AND_DETECTOR = 0x3
_ROS = b"enclave="  # rmw_fastrtps gives this user data to each of its participants


class RollCall:
    """An announced participant that is new to all participants of a machine, and their answers.

    Attributes:
        answered: The GUID prefixes of the ROS participants that answered the last call.
        strangers: The GUID prefixes of those that answered and do not belong to ROS.
    """

    def __init__(self) -> None:
        self.answered: set[bytes] = set()
        self.strangers: set[bytes] = set()
        self._open()
        self._prefix = bytes(_PREFIX)
        self._asked: frozenset[int] = frozenset()

    def _open(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((LOOPBACK, 0))
        self._socket.setblocking(False)

    def call(self, ports: Iterable[int]) -> None:
        """Ask all participants that listen for announcements on these ports, and begin a new list of answers."""
        self.close()
        self._open()  # late answers to an earlier call go to the old socket
        self.answered, self.strangers = set(), set()
        self._prefix = _VENDOR + os.urandom(_PREFIX - len(_VENDOR))
        self._asked = frozenset(ports)
        self._send(_announcement(self._prefix, self._socket.getsockname()[1]), self._asked)

    def listen(self, own_ports: Iterable[int]) -> None:
        """Record the answers so far, and pass each on to this process's own participant."""
        for message in self._received():
            prefix = message[_HEADER - _PREFIX : _HEADER]
            if message.startswith(_MAGIC) and _ANNOUNCER in message:
                (self.answered if _ROS in message else self.strangers).add(prefix)
                self._send(message, own_ports)

    def close(self) -> None:
        """Withdraw the announced participant."""
        self._send(_disposal(self._prefix), self._asked)
        self._socket.close()

    def _received(self) -> Iterator[bytes]:
        with contextlib.suppress(BlockingIOError):
            while True:
                yield self._socket.recv(_LONGEST)

    def _send(self, message: bytes, ports: Iterable[int]) -> None:
        for port in ports:
            # A participant that has ended, or whose socket is full, is asked again in the next call.
            with contextlib.suppress(OSError):
                self._socket.sendto(message, (LOOPBACK, port))


def _announcement(prefix: bytes, port: int) -> bytes:
    locator = struct.pack("<iI12x4s", 1, port, socket.inet_aton(LOOPBACK))
    payload = b"\x00\x03\x00\x00" + _parameters(
        (0x0015, _VERSION + b"\x00\x00"),
        (0x0016, _VENDOR + b"\x00\x00"),
        (0x0050, prefix + _PARTICIPANT),
        (0x0032, locator),
        (0x0031, locator),
        (0x0002, struct.pack("<iI", _LEASE, 0)),
        (0x0058, struct.pack("<I", _ANNOUNCER_AND_DETECTOR)),
    )
    return _message(prefix, _PAYLOAD, 1, payload)


def _disposal(prefix: bytes) -> bytes:
    state = _parameters((0x0070, prefix + _PARTICIPANT), (0x0071, b"\x00\x00\x00\x03"))
    return _message(prefix, _INLINE_QOS, 2, state)


def _parameters(*pairs: tuple[int, bytes]) -> bytes:
    return b"".join(struct.pack("<HH", pid, len(value)) + value for pid, value in pairs) + b"\x01\x00\x00\x00"


def _message(prefix: bytes, flags: int, number: int, content: bytes) -> bytes:
    body = struct.pack("<HH4s4siI", 0, 16, _DETECTOR, _ANNOUNCER, 0, number) + content
    head = struct.pack("<BBH", _DATA, flags | _LITTLE_ENDIAN, len(body))
    return _MAGIC + _VERSION + _VENDOR + prefix + head + body
