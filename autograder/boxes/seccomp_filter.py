"""The system calls that programs in a box may not make, as a seccomp filter.

The namespaces decide what a box can reach. In addition, the filter refuses:

* calls that no exercise needs and that have had security holes: tracing other processes, mounting, nested namespaces,
  keys, BPF, io_uring;
* watching files (inotify), because all boxes and programs of a user share 128 watches; programs then poll files;
* semaphores and messages of System V, because a few thousand calls take gigabytes that belong to no process;
* asynchronous input and output (``io_setup``), because all programs of the machine share one number of requests;
* leases (``fcntl``), because a lease delays other processes that open the file, such as a Python module, by up to 45
  seconds;
* calls that take kernel memory that neither cgroups nor the guard count: attributes of files (access control lists),
  memory policies (``mbind``), names of memory areas (``prctl``), filters of sockets and of system calls;
* tables of open files that ``/proc/PID/fd`` does not show, so that the guard cannot count them;
* memory and labels of sockets that Linux counts for the user or for the whole machine (:data:`_SOCKET_OPTIONS`);
* locks that ``/proc/locks`` does not show for a box, so that the guard (:mod:`autograder.boxes.limit_guards`) cannot
  count them: those of open file descriptions, and of ended processes whose table of open files is shared;
* network protocols whose waiting data the guard does not count: all except UDP, TCP, and netlink to list interfaces.

A refused call fails with EPERM, as for any user without the right to make it, with two exceptions. Calls for attributes
of files fail with EOPNOTSUPP, as on a file system without attributes, which ``cp -p`` expects. And ``clone3`` fails
with ENOSYS, as if it did not exist, so that libraries use ``clone`` instead: the flags of ``clone3`` are in memory that
a filter cannot read.

The numbers come from the kernel's own tables (asm/unistd_64.h, asm-generic/unistd.h), which never change.
"""

from __future__ import annotations

import errno
import fcntl
import platform
import socket
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

CLONE_FILES = 0x00000400
CLONE_THREAD = 0x00010000
CLONE_NEWNS = 0x00020000
CLONE_NEWCGROUP = 0x02000000
CLONE_NEWUTS = 0x04000000
CLONE_NEWIPC = 0x08000000
CLONE_NEWUSER = 0x10000000
CLONE_NEWPID = 0x20000000
CLONE_NEWNET = 0x40000000
"""The last of the flags of ``clone`` and ``unshare`` (linux/sched.h). The flags CLONE_NEW… are for namespaces."""
PR_SET_SECCOMP = 22
"""The option of ``prctl`` that installs a filter of system calls (linux/prctl.h)."""

_X86_64: Mapping[str, int] = {
    "ioctl": 16, "shmget": 29, "socket": 41, "socketpair": 53, "setsockopt": 54, "clone": 56, "semget": 64,
    "msgget": 68, "fcntl": 72, "ptrace": 101, "syslog": 103,
    "uselib": 134, "vhangup": 153, "modify_ldt": 154, "pivot_root": 155, "prctl": 157, "chroot": 161, "acct": 163,
    "settimeofday": 164, "mount": 165, "umount2": 166, "swapon": 167, "swapoff": 168, "reboot": 169,
    "sethostname": 170, "setdomainname": 171, "iopl": 172, "ioperm": 173, "init_module": 175,
    "delete_module": 176, "quotactl": 179, "setxattr": 188, "lsetxattr": 189, "fsetxattr": 190, "io_setup": 206,
    "lookup_dcookie": 212, "clock_settime": 227, "mbind": 237, "set_mempolicy": 238,
    "kexec_load": 246, "add_key": 248, "request_key": 249,
    "keyctl": 250, "inotify_init": 253, "unshare": 272, "inotify_init1": 294,
    "vmsplice": 278,
    "perf_event_open": 298, "fanotify_init": 300, "name_to_handle_at": 303, "open_by_handle_at": 304, "setns": 308,
    "process_vm_readv": 310, "process_vm_writev": 311, "kcmp": 312, "finit_module": 313, "seccomp": 317,
    "memfd_create": 319,
    "kexec_file_load": 320, "bpf": 321, "userfaultfd": 323,
}  # fmt: skip
_AARCH64: Mapping[str, int] = {
    "io_setup": 0, "setxattr": 5, "lsetxattr": 6, "fsetxattr": 7,
    "lookup_dcookie": 18, "fcntl": 25, "inotify_init1": 26, "ioctl": 29, "umount2": 39, "mount": 40,
    "pivot_root": 41, "chroot": 51, "vhangup": 58,
    "quotactl": 60, "acct": 89, "unshare": 97, "kexec_load": 104, "init_module": 105, "delete_module": 106,
    "clock_settime": 112, "syslog": 116, "ptrace": 117, "reboot": 142, "sethostname": 161,
    "vmsplice": 75,
    "setdomainname": 162, "prctl": 167, "settimeofday": 170, "msgget": 186, "semget": 190, "shmget": 194, "socket": 198,
    "socketpair": 199, "setsockopt": 208, "add_key": 217, "request_key": 218, "keyctl": 219, "clone": 220,
    "swapon": 224, "swapoff": 225,
    "mbind": 235, "set_mempolicy": 237,
    "perf_event_open": 241, "fanotify_init": 262, "name_to_handle_at": 264, "open_by_handle_at": 265,
    "setns": 268, "process_vm_readv": 270, "process_vm_writev": 271, "kcmp": 272, "finit_module": 273,
    "seccomp": 277, "memfd_create": 279, "bpf": 280, "userfaultfd": 282, "kexec_file_load": 294,
}  # fmt: skip
_EVERYWHERE: Mapping[str, int] = {
    "io_uring_setup": 425, "io_uring_enter": 426, "io_uring_register": 427, "open_tree": 428,
    "move_mount": 429, "fsopen": 430, "fsconfig": 431, "fsmount": 432, "fspick": 433, "clone3": 435,
    "close_range": 436, "pidfd_getfd": 438, "mount_setattr": 442, "quotactl_fd": 443, "memfd_secret": 447,
    "set_mempolicy_home_node": 450,
    "setxattrat": 463,
}  # fmt: skip
_READERS: Mapping[str, Mapping[str, int]] = {
    "x86_64": {
        "read": 0, "write": 1, "close": 3, "lseek": 8, "mmap": 9, "mprotect": 10, "munmap": 11, "brk": 12,
        "rt_sigreturn": 15, "pread64": 17, "mremap": 25, "madvise": 28, "exit": 60, "clock_gettime": 228,
        "exit_group": 231,
    },
    "aarch64": {
        "close": 57, "lseek": 62, "read": 63, "write": 64, "pread64": 67, "exit": 93, "exit_group": 94,
        "clock_gettime": 113, "rt_sigreturn": 139, "brk": 214, "munmap": 215, "mremap": 216, "mmap": 222,
        "mprotect": 226, "madvise": 233,
    },
}  # fmt: skip
"""The system calls that a reader may make. None of them opens a file, starts a process, sends a message, waits, or sets
a signal handler.
"""
_DESKS: Mapping[str, Mapping[str, int]] = {
    "x86_64": {
        "poll": 7, "sched_yield": 24, "nanosleep": 35, "getpid": 39, "sendto": 44,
        "recvfrom": 45, "gettid": 186, "futex": 202, "restart_syscall": 219, "clock_nanosleep": 230, "epoll_wait": 232,
        "epoll_ctl": 233, "ppoll": 271, "epoll_pwait": 281, "getrandom": 318,
    },
    "aarch64": {
        "epoll_ctl": 21, "epoll_pwait": 22, "ppoll": 73, "futex": 98, "nanosleep": 101, "clock_nanosleep": 115,
        "sched_yield": 124, "restart_syscall": 128, "getpid": 172, "gettid": 178,
        "sendto": 206, "recvfrom": 207, "getrandom": 278,
    },
}  # fmt: skip
"""The system calls that the desk of a Jupyter kernel may make in addition to those of a reader.

With these calls, the desk waits for messages on its existing connections, and reads and writes there. It opens no
connections and starts no processes.
"""
_FUTEX = {"x86_64": 202, "aarch64": 98}
_FUTEX_WAKE = (1, 129)
"""FUTEX_WAKE, and its variant for a single process (linux/futex.h). A program that releases a lock makes this call
even if no thread waits for the lock. A call that waits for a lock is not allowed.
"""
_BY_ARGUMENT = {
    "clone",
    "clone3",
    "socket",
    "socketpair",
    "setsockopt",
    "ioctl",
    "fcntl",
    "prctl",
    "close_range",
}
_ATTRIBUTES = {"setxattr", "lsetxattr", "fsetxattr", "setxattrat"}
_HIDDEN_MEMORY = {"memfd_create", "shmget", "vmsplice"}
"""Calls that allocate memory that belongs to no process. They are refused if the guard has no cgroup and counts process
by process.

For example, a hundred pipes with pages of a process (``vmsplice``) hold 3 GB after the process has freed these pages.
"""

_NETLINK, _ROUTE = 16, 0
"""AF_NETLINK, and its protocol for listing the network interfaces (linux/netlink.h)."""
_COUNTED = (0, socket.IPPROTO_TCP, socket.IPPROTO_UDP)
"""The protocols whose waiting data a guard can find in tables of ``/proc``; 0 is the default of a socket type.

MPTCP, SCTP and SMC have no such table, so they are not allowed.
"""
_PROTOCOLS = {socket.AF_INET: _COUNTED, socket.AF_INET6: _COUNTED, _NETLINK: (_ROUTE,)}
"""The allowed protocols by address family.

AF_UNIX is not here because it has no protocols. AF_VSOCK is left out on purpose: it reaches the host of a virtual
machine past every network namespace.
"""
_SOCKET_OPTIONS = {1: (26, 50, 51, 52, 60), 41: (32,)}
"""The refused options of ``setsockopt``, by level.

For SOL_SOCKET, they attach a filter to a socket (SO_ATTACH_FILTER, SO_ATTACH_BPF and the two filters of SO_REUSEPORT),
or lock memory that Linux counts for the user (SO_ZEROCOPY; asm-generic/socket.h). For IPPROTO_IPV6, the option takes
flow labels, of which the machine has 4,096 for all networks (IPV6_FLOWLABEL_MGR; linux/in6.h).
"""
_UNSHARES_DESCRIPTORS = 2
"""The flag of ``close_range`` that gives a thread a table of open files of its own (linux/close_range.h)."""
_TERMINAL_TRICKS = (0x5412, 0x541C)
"""TIOCSTI, which types into a terminal, and TIOCLINUX, which pastes into a console (asm-generic/ioctls.h)."""
_OTHERS_WAIT = (fcntl.F_SETLEASE, fcntl.F_NOTIFY, 1040)
"""Commands for leases, for signals when a folder changes, and for a combination of both (F_SETDELEG, Linux 6.19;
linux/fcntl.h).
"""
_LOCKS_OF_NOBODY = (37, 38)
"""F_OFD_SETLK and F_OFD_SETLKW: locks that belong to an open file description and not to a process
(asm-generic/fcntl.h).
"""
_NAMES_OF_MEMORY = 0x53564D41
"""PR_SET_VMA, with which a process may give each of its 65,530 pieces of memory a name (linux/prctl.h)."""
_NAMESPACES = (
    CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC
    | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET
)  # fmt: skip


@dataclass(frozen=True)
class Architecture:
    """The system calls of a processor architecture.

    Attributes:
        audit: The number of the architecture for seccomp (linux/audit.h).
        calls: The numbers of the calls by name.
        x32: True if a bit of the call's number selects a second table of calls.
    """

    audit: int
    calls: Mapping[str, int]
    x32: bool = False


ARCHITECTURES = {
    "x86_64": Architecture(0xC000003E, {**_X86_64, **_EVERYWHERE}, x32=True),
    "aarch64": Architecture(0xC00000B7, {**_AARCH64, **_EVERYWHERE}),
}

_LOAD, _AND, _JUMP_EQUAL, _JUMP_AT_LEAST, _JUMP_BITS, _RETURN = 0x20, 0x54, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL, _ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
_NUMBER, _ARCH, _ARGUMENTS = 0, 4, 16
"""Offsets in the data that a filter reads (struct seccomp_data in linux/seccomp.h): the call's number, the
architecture, the arguments. An argument has 8 bytes, the low half first.
"""


def filter_for_boxes(*, hidden_memory: bool = True, machine: str = "") -> bytes:
    """Return the filter program for a machine; empty if the machine's system calls are not known here.

    Args:
        hidden_memory: True to allow memory that belongs to no process, such as memfd. Pass True only if a cgroup counts
            such memory.
        machine: The machine as in ``uname -m``; by default this machine.
    """
    known = ARCHITECTURES.get(machine or platform.machine())
    if known is None:
        return b""
    refused = sorted(
        number
        for name, number in known.calls.items()
        if name not in _BY_ARGUMENT and not (hidden_memory and name in _HIDDEN_MEMORY)
    )
    program = _beginning(known)
    attributes = {known.calls[name] for name in _ATTRIBUTES}
    for number in refused:
        why = errno.EOPNOTSUPP if number in attributes else errno.EPERM
        program += [(_JUMP_EQUAL, 0, 1, number), _fail(why)]
    calls = known.calls
    # clone3 passes its flags in memory, which a filter cannot read. After ENOSYS, the C library calls clone instead.
    program += [(_JUMP_EQUAL, 0, 1, calls["clone3"]), _fail(errno.ENOSYS)]
    program += _where(calls["clone"], _decide_on_clone())
    program += _where(calls["ioctl"], _refuse_any(1, _TERMINAL_TRICKS))
    program += _where(calls["fcntl"], _refuse_any(1, (*_OTHERS_WAIT, *_LOCKS_OF_NOBODY)))
    program += _where(calls["prctl"], _refuse_any(0, (PR_SET_SECCOMP, _NAMES_OF_MEMORY)))
    program += _where(calls["setsockopt"], _decide_on_socket_option())
    program += _where(
        calls["close_range"], [_load(2), (_JUMP_BITS, 0, 1, _UNSHARES_DESCRIPTORS), _fail(errno.EPERM)]
    )
    program += _where(calls["socket"], _decide_on_socket())
    program += _where(calls["socketpair"], _refuse_others(0, (socket.AF_UNIX,), errno.EAFNOSUPPORT))
    program.append((_RETURN, 0, 0, _ALLOW))
    return _packed(program)


def filter_for_readers(machine: str = "") -> bytes:
    """Return the filter for a process that only reads what it was given and writes its answer.

    Such a process cannot open, start or reach anything, so no data of one student is left for the next, even if their
    processes share a box. It cannot sleep, either: it ends, or it uses up its processor time.

    Args:
        machine: The machine as in ``uname -m``; by default this machine.
    """
    machine = machine or platform.machine()
    decide_on_futex = _where(_FUTEX.get(machine, 0), _refuse_others(1, _FUTEX_WAKE, errno.EPERM))
    return _filter_with(machine, [_READERS], decide_on_futex)


def filter_for_desks(machine: str = "") -> bytes:
    """Return the filter for the desk of a Jupyter kernel, which reads from existing connections to the kernel.

    A desk cannot open files, start processes, or make further connections.

    Args:
        machine: As for :func:`filter_for_boxes`.
    """
    return _filter_with(machine or platform.machine(), [_READERS, _DESKS])


def _filter_with(
    machine: str, tables: Iterable[Mapping[str, Mapping[str, int]]], decide: Sequence[_Instruction] = ()
) -> bytes:
    """Return a filter that refuses every call but those in the tables and those that ``decide`` allows."""
    if machine not in ARCHITECTURES:
        return b""
    program = _beginning(ARCHITECTURES[machine])
    for number in sorted(number for calls in tables for number in calls[machine].values()):
        program += [(_JUMP_EQUAL, 0, 1, number), (_RETURN, 0, 0, _ALLOW)]
    return _packed([*program, *decide, _fail(errno.EPERM)])


_Instruction = tuple[int, int, int, int]


def _beginning(known: Architecture) -> list[_Instruction]:
    """Return instructions that kill a process that uses another architecture's calls, and load the call's number."""
    program = [
        (_LOAD, 0, 0, _ARCH),
        (_JUMP_EQUAL, 1, 0, known.audit),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER),
    ]
    if known.x32:
        program += [(_JUMP_AT_LEAST, 0, 1, 0x40000000), _fail(errno.ENOSYS)]
    return program


def _packed(program: Sequence[_Instruction]) -> bytes:
    return b"".join(struct.pack("=HBBI", *instruction) for instruction in program)


def _fail(number: int) -> _Instruction:
    return (_RETURN, 0, 0, _ERRNO | number)


def _where(call: int, decide: Sequence[_Instruction]) -> list[_Instruction]:
    """Return instructions that decide, by its arguments, about one system call.

    The call is allowed unless ``decide`` refuses it.
    """
    body = [*decide, (_RETURN, 0, 0, _ALLOW)]
    return [(_JUMP_EQUAL, 0, len(body), call), *body]


def _load(argument: int) -> _Instruction:
    """Return an instruction to load the low 32 bits of an argument. In an argument with flags, only these matter."""
    return (_LOAD, 0, 0, _ARGUMENTS + 8 * argument)


def _refuse_any(argument: int, values: Sequence[int]) -> list[_Instruction]:
    return [
        _load(argument),
        *(step for value in values for step in ((_JUMP_EQUAL, 0, 1, value), _fail(errno.EPERM))),
    ]


def _refuse_others(argument: int, values: Sequence[int], why: int) -> list[_Instruction]:
    allowed = [step for value in values for step in ((_JUMP_EQUAL, 0, 1, value), (_RETURN, 0, 0, _ALLOW))]
    return [_load(argument), *allowed, _fail(why)]


def _decide_on_clone() -> list[_Instruction]:
    """Return instructions that refuse new namespaces, and unusual tables of open files.

    All threads of a process share one table, and no two processes do, because a guard counts the table of a process.
    """
    thread = CLONE_FILES | CLONE_THREAD
    return [
        _load(0),
        (_JUMP_BITS, 0, 1, _NAMESPACES),
        _fail(errno.EPERM),
        (_AND, 0, 0, thread),
        (_JUMP_EQUAL, 2, 0, 0),
        (_JUMP_EQUAL, 1, 0, thread),
        _fail(errno.EPERM),
    ]


def _decide_on_socket_option() -> list[_Instruction]:
    program = []
    for level, options in _SOCKET_OPTIONS.items():
        body = [*_refuse_any(2, options), (_RETURN, 0, 0, _ALLOW)]
        program += [_load(1), (_JUMP_EQUAL, 0, len(body), level), *body]
    return program


def _decide_on_socket() -> list[_Instruction]:
    program = [_load(0), (_JUMP_EQUAL, 0, 1, socket.AF_UNIX), (_RETURN, 0, 0, _ALLOW)]
    for family, protocols in _PROTOCOLS.items():
        body = _refuse_others(2, protocols, errno.EPROTONOSUPPORT)
        program += [(_JUMP_EQUAL, 0, len(body), family), *body]
    return [*program, _fail(errno.EAFNOSUPPORT)]
