"""Finds the participants of a domain on this machine, by asking the operating system.

Each DDS participant uses a UDP port of its domain, so the participants are known before they are discovered.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

# Ports of RTPS (OMG DDSI-RTPS 2.3, 9.6.1): a domain has 250 of them, and the discovery port of its n-th
# participant on a machine is number 10 + 2n.
_BASE, _PER_DOMAIN, _FIRST_UNICAST = 7400, 250, 10
_SOCKET_TABLES = ("/proc/net/udp", "/proc/net/udp6")
_STOPPED = frozenset("TtZX")  # the states (proc(5)) of a process that does not answer because it is stopped


@dataclass(frozen=True)
class Ports:
    """The discovery ports of a domain that are in use on this machine.

    Attributes:
        own: The ports of this process.
        others: The ports of all other processes, except stopped ones.
    """

    own: frozenset[int]
    others: frozenset[int]


def domain_id() -> int:
    """Return the value of ROS_DOMAIN_ID; 0 if it is not set.

    Raises:
        RuntimeError: The value is not a number from 0 to 232.
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
    """Return True if ROS_AUTOMATIC_DISCOVERY_RANGE limits discovery to this machine."""
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() in {"LOCALHOST", "OFF"}


def ports_in_use(
    domain: int, tables: Iterable[str] = _SOCKET_TABLES, processes: Path = Path("/proc")
) -> Ports | None:
    """Return the discovery ports of a domain that are in use; None if Linux's tables are missing."""
    sockets = _sockets(domain, tables)
    if sockets is None:
        return None
    own = _inodes(processes / "self")
    mine = frozenset(port for inode, port in sockets.items() if inode in own)
    others = frozenset(sockets.values()) - mine
    return Ports(mine, others - _held_by_stopped(sockets, processes) if others else others)


def _sockets(domain: int, tables: Iterable[str]) -> dict[int, int] | None:
    """Return ports by the inodes of their sockets."""
    start = _BASE + _PER_DOMAIN * domain
    wanted = range(start + _FIRST_UNICAST, start + _PER_DOMAIN, 2)
    found: dict[int, int] = {}
    seen = False
    for table in tables:
        try:
            lines = Path(table).read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        seen = True
        for line in lines:
            columns = line.split()
            address, _, port = columns[1].rpartition(":")
            # A participant listens on all addresses. A socket on one address, like the judge's for announcements, is
            # not one.
            if int(address, 16) == 0 and int(port, 16) in wanted:
                found[int(columns[9])] = int(port, 16)
    return found if seen else None


def _held_by_stopped(sockets: dict[int, int], processes: Path) -> frozenset[int]:
    """Return the ports of processes that are stopped (Ctrl-Z, a debugger). They answer once they continue."""
    held: set[int] = set()
    # A longer pattern would also check that the rest of the path exists, which raises an error for a process that has
    # just ended.
    for process in processes.glob("[0-9]*"):
        try:
            said = (process / "stat").read_text(encoding="utf-8", errors="replace")
        except OSError:  # the process has ended
            continue
        if said.rpartition(")")[2].split()[0] in _STOPPED:
            held.update(sockets[inode] for inode in _inodes(process) & sockets.keys())
    return frozenset(held)


def _inodes(process: Path) -> set[int]:
    """Return the inodes of a process's sockets; none if it belongs to another user, or has ended."""
    found: set[int] = set()
    try:
        for link in (process / "fd").iterdir():
            try:
                target = link.readlink().name
            except OSError:  # the descriptor was closed meanwhile
                continue
            if target.startswith("socket:["):
                found.add(int(target[len("socket:[") : -1]))
    except OSError:
        pass
    return found
