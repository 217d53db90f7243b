"""Picks a ROS domain that no other process on this host uses.

If two students on one host both stay on domain 0, they hear each other's ``/chatter``. A domain is free when none of
its UDP ports is taken. It stays ours because this process keeps one of its ports bound, one that DDS itself never
uses: the operating system refuses it to other processes, and frees it when this process ends, however it ends.

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
"""Domain 0 is every program's default; from 102 on the ports overlap with Linux's range for outgoing connections."""
HIGHEST_DOMAIN = 232
"""The last domain whose ports are valid UDP port numbers."""

_PORT_BASE = 7400
_DOMAIN_GAIN = 250
_CLAIM_OFFSET = 9
"""RTPS uses the offsets 0, 1 and those from 10 on; the ones in between are unused."""
GROUP_OFFSET = 0
"""Multicast discovery."""
PARTICIPANT_OFFSET = 10
"""Discovery of a domain's first participant; that of the next one is two higher."""
_PROBED_OFFSETS = (GROUP_OFFSET, *range(PARTICIPANT_OFFSET, PARTICIPANT_OFFSET + 16, 2))
"""Multicast discovery, and the first eight participants: a new participant takes the lowest free index."""


class NoFreeDomainError(RuntimeError):
    """Every domain that could be picked is in use on this host."""


@dataclass(frozen=True)
class DomainClaim:
    """A ROS domain that this process holds until it ends or calls ``release``.

    Attributes:
        domain: The domain's number.
    """

    domain: int
    _socket: socket.socket

    def release(self) -> None:
        """Give the domain back, so that another process may pick it."""
        self._socket.close()


def claim_free_domain(candidates: Iterable[int] | None = None) -> DomainClaim:
    """Pick a ROS domain that no other process uses and hold it.

    Args:
        candidates: Domains to try, in this order; None for 1 to 101 in random order.

    Raises:
        NoFreeDomainError: All of them are taken.
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
        f"close some kernels, or choose one yourself by setting {DOMAIN_VARIABLE}"
    )


def domain_from_environment() -> int | None:
    """Return the domain in ``ROS_DOMAIN_ID``, or None if it is not set.

    Raises:
        ValueError: Its value is not a domain.
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
    """Return the UDP port of a domain that is ``offset`` above its first port."""
    return _PORT_BASE + _DOMAIN_GAIN * domain + offset


def _looks_used(domain: int) -> bool:
    for offset in _PROBED_OFFSETS:
        probe = _bind(port(domain, offset))
        if probe is None:
            return True
        probe.close()
    return False


def _bind(port: int) -> socket.socket | None:
    """Return a UDP socket on the loopback address, or None if the port is taken."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        udp.bind(("127.0.0.1", port))
    except OSError:
        udp.close()
        return None
    return udp
