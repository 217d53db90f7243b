"""The system calls that no program in a box may make, as a seccomp filter.

The namespaces decide what a box can reach. The filter takes away what no answer to an exercise needs and where kernels
had their holes: tracing other processes, mounting, namespaces in namespaces, keys, BPF, io_uring. Watching files
(inotify) is among it because a user has 128 of such watches for all boxes and programs together; programs that watch
look now and then instead where they cannot. Semaphores and messages of System V are among it because the kernel gives
some thousand calls gigabytes that no process is seen to have, and asynchronous input and output (``io_setup``) because
all programs of the machine share one number of requests. A lease (``fcntl``) makes everybody else who opens a file wait
for up to 45 seconds, also where the file is read-only here: Python's own modules are the same files in every box. A
call that is refused fails with EPERM, as it does for any user without the right to it; ``clone3`` does not exist
(ENOSYS), because its flags are in memory that a filter cannot read, and libraries then use ``clone``.

Numbers are those of the kernel's own tables (asm/unistd_64.h, asm-generic/unistd.h), which no kernel ever changes.
"""

from __future__ import annotations

import errno
import fcntl
import platform
import socket
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.boxes import syscalls

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_X86_64: Mapping[str, int] = {
    "ioctl": 16, "shmget": 29, "socket": 41, "socketpair": 53, "clone": 56, "semget": 64,
    "msgget": 68, "fcntl": 72, "ptrace": 101, "syslog": 103,
    "uselib": 134, "vhangup": 153, "modify_ldt": 154, "pivot_root": 155, "chroot": 161, "acct": 163,
    "settimeofday": 164, "mount": 165, "umount2": 166, "swapon": 167, "swapoff": 168, "reboot": 169,
    "sethostname": 170, "setdomainname": 171, "iopl": 172, "ioperm": 173, "init_module": 175,
    "delete_module": 176, "quotactl": 179, "io_setup": 206, "lookup_dcookie": 212, "clock_settime": 227,
    "kexec_load": 246, "add_key": 248, "request_key": 249, "keyctl": 250, "inotify_init": 253, "unshare": 272,
    "inotify_init1": 294,
    "perf_event_open": 298, "fanotify_init": 300, "name_to_handle_at": 303, "open_by_handle_at": 304, "setns": 308,
    "process_vm_readv": 310, "process_vm_writev": 311, "kcmp": 312, "finit_module": 313, "memfd_create": 319,
    "kexec_file_load": 320, "bpf": 321, "userfaultfd": 323,
}  # fmt: skip
_AARCH64: Mapping[str, int] = {
    "io_setup": 0, "lookup_dcookie": 18, "fcntl": 25, "inotify_init1": 26, "ioctl": 29, "umount2": 39, "mount": 40,
    "pivot_root": 41, "chroot": 51, "vhangup": 58,
    "quotactl": 60, "acct": 89, "unshare": 97, "kexec_load": 104, "init_module": 105, "delete_module": 106,
    "clock_settime": 112, "syslog": 116, "ptrace": 117, "reboot": 142, "sethostname": 161,
    "setdomainname": 162, "settimeofday": 170, "msgget": 186, "semget": 190, "shmget": 194, "socket": 198,
    "socketpair": 199, "add_key": 217, "request_key": 218, "keyctl": 219, "clone": 220, "swapon": 224, "swapoff": 225,
    "perf_event_open": 241, "fanotify_init": 262, "name_to_handle_at": 264, "open_by_handle_at": 265,
    "setns": 268, "process_vm_readv": 270, "process_vm_writev": 271, "kcmp": 272, "finit_module": 273,
    "memfd_create": 279, "bpf": 280, "userfaultfd": 282, "kexec_file_load": 294,
}  # fmt: skip
_EVERYWHERE: Mapping[str, int] = {
    "io_uring_setup": 425, "io_uring_enter": 426, "io_uring_register": 427, "open_tree": 428,
    "move_mount": 429, "fsopen": 430, "fsconfig": 431, "fsmount": 432, "fspick": 433, "clone3": 435,
    "pidfd_getfd": 438, "mount_setattr": 442, "quotactl_fd": 443, "memfd_secret": 447,
}  # fmt: skip
_BY_ARGUMENT = {"clone", "clone3", "socket", "socketpair", "ioctl", "fcntl"}
_HIDDEN_MEMORY = {"memfd_create", "shmget"}
"""Memory that no process is seen to have: refused where it is watched process by process, without a cgroup."""

_FAMILIES = (socket.AF_UNIX, socket.AF_INET, socket.AF_INET6, 16)
"""16 is AF_NETLINK, with which programs list the network interfaces. AF_VSOCK above all is not here: it talks to
the host of a virtual machine, past every network namespace."""
_TERMINAL_TRICKS = (0x5412, 0x541C)
"""TIOCSTI types into a terminal, TIOCLINUX pastes into a console (asm-generic/ioctls.h)."""
_LEASES = (fcntl.F_SETLEASE, fcntl.F_NOTIFY, 1040)
"""Leases, signals when a folder changes, and what is both (F_SETDELEG, Linux 6.19; linux/fcntl.h)."""
_NAMESPACES = (
    syscalls.CLONE_NEWNS | syscalls.CLONE_NEWCGROUP | syscalls.CLONE_NEWUTS | syscalls.CLONE_NEWIPC
    | syscalls.CLONE_NEWUSER | syscalls.CLONE_NEWPID | syscalls.CLONE_NEWNET
)  # fmt: skip


@dataclass(frozen=True)
class Architecture:
    """A machine's system calls.

    Attributes:
        audit: What seccomp calls it (linux/audit.h).
        calls: Numbers by name.
        x32: Whether a second table hides behind a bit of the number.
    """

    audit: int
    calls: Mapping[str, int]
    x32: bool = False


ARCHITECTURES = {
    "x86_64": Architecture(0xC000003E, {**_X86_64, **_EVERYWHERE}, x32=True),
    "aarch64": Architecture(0xC00000B7, {**_AARCH64, **_EVERYWHERE}),
}

_LOAD, _JUMP_EQUAL, _JUMP_AT_LEAST, _JUMP_BITS, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL, _ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
_NUMBER, _ARCH, _ARGUMENTS = 0, 4, 16
"""Offsets in what a filter sees (linux/seccomp.h, struct seccomp_data); an argument has 8 bytes, low half first."""


def filter_for_boxes(*, hidden_memory: bool = True, machine: str = "") -> bytes:
    """The filter's program for this machine; empty for one whose system calls are not known here.

    Args:
        hidden_memory: Allow memory that belongs to no process; it counts in a cgroup.
        machine: As ``uname -m`` says it; this machine's by default.
    """
    known = ARCHITECTURES.get(machine or platform.machine())
    if known is None:
        return b""
    refused = sorted(
        number
        for name, number in known.calls.items()
        if name not in _BY_ARGUMENT and not (hidden_memory and name in _HIDDEN_MEMORY)
    )
    program = [
        (_LOAD, 0, 0, _ARCH),
        (_JUMP_EQUAL, 1, 0, known.audit),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER),
    ]
    if known.x32:
        program += [(_JUMP_AT_LEAST, 0, 1, 0x40000000), _fail(errno.ENOSYS)]
    for number in refused:
        program += [(_JUMP_EQUAL, 0, 1, number), _fail(errno.EPERM)]
    calls = known.calls
    program += [(_JUMP_EQUAL, 0, 1, calls["clone3"]), _fail(errno.ENOSYS)]
    program += _where(calls["clone"], 0, [(_JUMP_BITS, 0, 1, _NAMESPACES), _fail(errno.EPERM)])
    program += _where(calls["ioctl"], 1, _refuse_any(_TERMINAL_TRICKS))
    program += _where(calls["fcntl"], 1, _refuse_any(_LEASES))
    program += _where(calls["socket"], 0, _refuse_others(_FAMILIES))
    program += _where(calls["socketpair"], 0, _refuse_others((socket.AF_UNIX,)))
    program.append((_RETURN, 0, 0, _ALLOW))
    return b"".join(struct.pack("=HBBI", *instruction) for instruction in program)


_Instruction = tuple[int, int, int, int]


def _fail(number: int) -> _Instruction:
    return (_RETURN, 0, 0, _ERRNO | number)


def _where(call: int, argument: int, decide: Sequence[_Instruction]) -> list[_Instruction]:
    """For one call, decide by the low half of an argument; what is not decided is allowed.

    The kernel, too, takes no more than the low half of a flag, a family or a command.
    """
    body = [(_LOAD, 0, 0, _ARGUMENTS + 8 * argument), *decide, (_RETURN, 0, 0, _ALLOW)]
    return [(_JUMP_EQUAL, 0, len(body), call), *body]


def _refuse_any(values: Sequence[int]) -> list[_Instruction]:
    return [step for value in values for step in ((_JUMP_EQUAL, 0, 1, value), _fail(errno.EPERM))]


def _refuse_others(values: Sequence[int]) -> list[_Instruction]:
    allowed = [step for value in values for step in ((_JUMP_EQUAL, 0, 1, value), (_RETURN, 0, 0, _ALLOW))]
    return [*allowed, _fail(errno.EAFNOSUPPORT)]
