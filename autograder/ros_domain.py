"""Picks a ROS domain that no other process on this computer uses.

If two students on one computer both stayed on domain 0, they would hear each other's ``/chatter``. A domain counts as
free if none of its UDP ports is in use. To reserve it, this process keeps one of the domain's ports bound, one that
DDS itself never uses. The operating system refuses this port to other processes, and frees it when this process ends,
however it ends.

The port numbers are those of the DDS Interoperability Wire Protocol (RTPS), section 9.6.1.1, with its default
parameters: port base 7400, domain gain 250, participant gain 2.
"""

from __future__ import annotations

import os
import random
import socket
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

DOMAIN_VARIABLE = "ROS_DOMAIN_ID"
FREE_TO_PICK = range(1, 102)
"""The domains to pick from. Domain 0 is every program's default; from 102 on, the ports overlap with Linux's range for
outgoing connections.
"""
HIGHEST_DOMAIN = 232
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
    if not text.isdecimal() or int(text) > HIGHEST_DOMAIN:
        raise ValueError(
            f"{DOMAIN_VARIABLE} is {text!r}, but a ROS domain is a whole number from 0 to {HIGHEST_DOMAIN} "
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
