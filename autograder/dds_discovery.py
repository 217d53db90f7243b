"""Controls which ROS nodes discover each other, and how soon: free domains, and participants that miss no answer.

If two students on one computer both stayed on domain 0, they would hear each other's ``/chatter``. A domain counts as
free if none of its UDP ports is in use. To reserve it, this process keeps one of the domain's ports bound, one that
DDS itself never uses. The operating system refuses this port to other processes, and frees it when this process ends,
however it ends. The port numbers are those of the DDS Interoperability Wire Protocol (RTPS), section 9.6.1.1, with its
default parameters: port base 7400, domain gain 250, participant gain 2.

Fast DDS 2.14 announces a new participant before it has registered the participant's receivers. Existing participants
answer within 0.1 ms, and only once. If a receiving thread reads such an answer too early, the answer is lost, and the
next one comes with the periodic announcement, up to 3 s later. One new participant in three was discovered that late.
So the threads of a new participant must not run before the thread that makes them has finished
(:func:`receivers_wait`).
"""

from __future__ import annotations

import contextlib
import os
import random
import socket
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

DOMAIN_VARIABLE = "ROS_DOMAIN_ID"
FREE_TO_PICK = range(1, 102)
"""The domains to pick from. Domain 0 is every program's default; from 102 on, the ports overlap with Linux's range for
outgoing connections.
"""
_HIGHEST_DOMAIN = 232
"""The last domain whose ports are valid UDP port numbers."""

_PORT_BASE = 7400
_DOMAIN_GAIN = 250
_CLAIM_OFFSET = 9
"""The offset of the port that reserves a domain. RTPS uses the offsets 0 and 1 and the offsets from 10 on, but not the
offsets 2 to 9.
"""
GROUP_OFFSET = 0
"""The port offset for multicast discovery."""
PARTICIPANT_OFFSET = 10
"""The port offset for the discovery of a domain's first participant. The offset of each next participant is two higher.
"""
_PROBED_OFFSETS = (GROUP_OFFSET, *range(PARTICIPANT_OFFSET, PARTICIPANT_OFFSET + 16, 2))
"""The offsets of the ports that show whether a domain is in use: those for multicast discovery and for the first eight
participants. A new participant takes the lowest free number.
"""


class NoFreeDomainError(RuntimeError):
    """Every domain that was tried is in use on this computer."""


@dataclass(frozen=True)
class DomainClaim:
    """A ROS domain that this process holds until it ends or calls ``release``.

    Attributes:
        domain: The number of the domain.
    """

    domain: int
    _socket: socket.socket

    def release(self) -> None:
        """Release the domain, so that another process may pick it."""
        self._socket.close()


def claim_free_domain(candidates: Iterable[int] | None = None) -> DomainClaim:
    """Pick a ROS domain that no other process uses, and hold it.

    Args:
        candidates: The domains to try, in this order; None for 1 to 101 in random order.

    Raises:
        NoFreeDomainError: All these domains are in use.
    """
    domains = random.sample(FREE_TO_PICK, len(FREE_TO_PICK)) if candidates is None else list(candidates)
    for domain in domains:
        holder = _bind(port(domain, _CLAIM_OFFSET))
        if holder is None:
            continue
        if _looks_used(domain):
            holder.close()
            continue
        return DomainClaim(domain, holder)
    raise NoFreeDomainError(
        f"all {len(domains)} ROS domains tried are in use on this host: "
        f"close some kernels, or choose a domain yourself by setting {DOMAIN_VARIABLE}"
    )


def domain_from_environment() -> int | None:
    """Return the domain in ``ROS_DOMAIN_ID``; None if it is not set.

    Raises:
        ValueError: The value is not a valid domain.
    """
    text = os.environ.get(DOMAIN_VARIABLE, "").strip()
    if not text:
        return None
    if not text.isdecimal() or int(text) > _HIGHEST_DOMAIN:
        raise ValueError(
            f"{DOMAIN_VARIABLE} is {text!r}, but a ROS domain is a whole number from 0 to {_HIGHEST_DOMAIN} "
            f"(0 to {FREE_TO_PICK[-1]} to be safe): correct it or unset it"
        )
    return int(text)


def port(domain: int, offset: int) -> int:
    """Return the UDP port that is ``offset`` above a domain's first port."""
    return _PORT_BASE + _DOMAIN_GAIN * domain + offset


def _looks_used(domain: int) -> bool:
    for offset in _PROBED_OFFSETS:
        probe = _bind(port(domain, offset))
        if probe is None:
            return True
        probe.close()
    return False


def _bind(port: int) -> socket.socket | None:
    """Return a UDP socket bound to a port on the loopback address; None if the port is in use."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        udp.bind(("127.0.0.1", port))
    except OSError:
        udp.close()
        return None
    return udp


UNNAMED = "_NODE_"
"""The beginning of the name that a participant reports for a node whose real name it does not know yet
(rmw_dds_common).
"""


@contextlib.contextmanager
def receivers_wait() -> Iterator[None]:
    """Return a context manager: threads that are started in its block run only after the block has ended.

    The threads and the thread that starts them share one processor, under a scheduling policy that does not interrupt a
    running thread (sched(7), SCHED_BATCH). If the operating system has no such policy, this has no effect.
    """
    if not hasattr(os, "SCHED_BATCH"):
        yield
        return
    processors, policy, priority = os.sched_getaffinity(0), os.sched_getscheduler(0), os.sched_getparam(0)
    before = _threads()
    with contextlib.suppress(OSError):
        os.sched_setaffinity(0, {max(processors)})
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    try:
        yield
    finally:
        for thread in (_threads() - before) | {threading.get_native_id()}:
            with contextlib.suppress(OSError):  # A thread may have ended meanwhile.
                os.sched_setaffinity(thread, processors)
                os.sched_setscheduler(thread, policy, priority)


def _threads() -> set[int]:
    return {int(entry.name) for entry in Path("/proc/self/task").iterdir()}
