"""Isolates a process: moves it into the namespaces of a box, applies limits, and gives up its rights.

The system calls for this that Python does not offer are functions here, which raise OSError. Their numbers come from
Linux's headers: linux/prctl.h, linux/capability.h, linux/sockios.h.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import os
import platform
import resource
import select
import signal
import socket
import struct
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from autograder.boxes.box_connection import Channel, ChannelClosed, close_all
from autograder.boxes.cgroups import join, memberships
from autograder.boxes.seccomp_filter import (
    CLONE_NEWIPC,
    CLONE_NEWNET,
    CLONE_NEWNS,
    CLONE_NEWPID,
    CLONE_NEWUSER,
    CLONE_NEWUTS,
    PR_SET_SECCOMP,
    filter_for_boxes,
    filter_for_readers,
)
from autograder.process_trees import adopt_orphans, die_with_parent, end_descendants

Run = Callable[[Mapping[str, Any], Sequence[int]], None]
"""The function that a child runs, given the request's ``call`` and descriptors."""


@dataclass(frozen=True)
class Entrance:
    """The settings with which a child of a fork server starts.

    Attributes:
        cwd: The working folder, as a path inside the box.
        environment: All environment variables.
        boxed: True to enter the box whose first process is given as a pidfd, the first descriptor of the request. False
            to stay outside any box, which is only for the course's own notebooks and ``--unsafe-no-sandbox``.
        cgroups: The ``cgroup.procs`` files to join, as paths outside the box.
        rlimits: Limits on each process, by their names in :mod:`resource`.
        hidden_memory: True to allow memory that belongs to no process; see
            :func:`autograder.boxes.seccomp_filter.filter_for_boxes`.
        call: The argument for the function ``run``.
        reader_seconds: The limit of processor time in seconds for a process that only reads and writes its descriptors
            (:func:`autograder.boxes.seccomp_filter.filter_for_readers`); 0 for any other process.
        filters_itself: True if the child installs its filter of system calls itself, as a kernel's desk does after it
            has connected to the kernel (:mod:`autograder.execution.kernel_desk`).
    """

    cwd: str
    environment: Mapping[str, str]
    boxed: bool
    cgroups: Sequence[str] = ()
    rlimits: Mapping[str, int] = field(default_factory=dict)
    hidden_memory: bool = True
    call: Mapping[str, Any] = field(default_factory=dict)
    reader_seconds: int = 0
    filters_itself: bool = False


def enter(channel: Channel, run: Run) -> None:
    """Serve one request in a child of a fork server: fork into the box, then watch the process there.

    The first answer is ``{"pid": …}``, the process's id as seen from the host. The second answer, when the process has
    ended, is ``{"status": …}`` with its wait status. If the other end of the connection closes first, the process is
    killed.
    """
    die_with_parent()
    message, descriptors = channel.receive()
    entrance = Entrance(**message)
    # Open the files of the cgroups now, while their paths are visible. But only the child joins the cgroups, because if
    # the box runs out of memory, the kernel must not kill this process, which watches the child.
    groups = memberships(entrance.cgroups)
    if entrance.boxed:
        namespaces = CLONE_NEWUSER | CLONE_NEWNS | CLONE_NEWPID | CLONE_NEWNET | CLONE_NEWIPC | CLONE_NEWUTS
        _check(_libc.setns(descriptors[0], namespaces), "setns")
    else:
        # Without a PID namespace, daemons that a student's code starts become children of this process, which ends
        # them.
        adopt_orphans()
    pid = os.fork()
    if pid == 0:
        channel.close()
        join(groups)
        _begin(entrance, descriptors, run)
    close_all([*descriptors, *groups])
    with contextlib.suppress(ChannelClosed):
        channel.send({"pid": pid})
    end = os.pidfd_open(pid)
    watched: list[Any] = [end, channel]
    ready, _, _ = select.select(watched, [], [])
    if end not in ready:
        # No further message is expected, so if the connection is readable, the other end has closed.
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    if not entrance.boxed:
        end_descendants()
    with contextlib.suppress(ChannelClosed):
        channel.send({"status": status})


def _begin(entrance: Entrance, descriptors: Sequence[int], run: Run) -> None:
    """Run the child after its fork: apply the limits, give up rights, call ``run``, and exit."""
    code = 1
    try:
        os.setsid()
        _apply_rlimits(entrance.rlimits)
        os.environ.clear()
        os.environ.update(entrance.environment)
        os.chdir(entrance.cwd)
        if entrance.boxed:
            close_all(descriptors[:1])
            descriptors = descriptors[1:]
            filters = filter_for_boxes(hidden_memory=entrance.hidden_memory)
            _give_up_rights(b"" if entrance.reader_seconds else filters)
        # Call this only now, because giving up rights clears the setting to die with the parent (PR_SET_PDEATHSIG,
        # prctl(2)). The parent's id is not passed, because the parent is in another PID namespace.
        die_with_parent()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if entrance.reader_seconds:
            # At this limit, SIGXCPU ends the process, which cannot catch or block the signal, because the filters of
            # readers and desks refuse the calls for it. Linux sends SIGKILL a second later. SIGKILL must not come
            # first, because the grader takes SIGKILL to mean that the machine is out of memory.
            resource.setrlimit(resource.RLIMIT_CPU, (entrance.reader_seconds, entrance.reader_seconds + 1))
            if not entrance.filters_itself:
                filter_system_calls(filter_for_readers())
        run(entrance.call, descriptors)
        code = 0
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _give_up_rights(filters: bytes) -> None:
    """Drop all capabilities, keep executed programs from gaining any, and install a filter of system calls."""
    last = int(Path("/proc/sys/kernel/cap_last_cap").read_text())
    for capability in range(last + 1):
        _prctl(_PR_CAPBSET_DROP, capability)
    _prctl(_PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL)
    header = struct.pack("=Ii", _CAPABILITY_VERSION_3, 0)
    _check(_libc.capset(header, bytes(24)), "capset")
    filter_system_calls(filters)
    # After a change of rights, a process cannot read its own /proc/self, as programs do, unless it is made dumpable.
    _prctl(PR_SET_DUMPABLE, 1)


def take_limits(cgroups: Sequence[str], rlimits: Mapping[str, int]) -> None:
    """Apply the limits of a box to this process, which is about to become bubblewrap."""
    join(memberships(cgroups))
    _apply_rlimits(rlimits)


def _apply_rlimits(limits: Mapping[str, int]) -> None:
    """Set the limits of this process and its children, as far as the system allows."""
    for name, value in limits.items():
        kind = getattr(resource, name)
        _, hard = resource.getrlimit(kind)
        wanted = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (wanted, wanted))


PR_SET_DUMPABLE = 4
_PR_CAPBSET_DROP = 24
_PR_SET_NO_NEW_PRIVS = 38
_PR_CAP_AMBIENT = 47
_PR_CAP_AMBIENT_CLEAR_ALL = 4
_SECCOMP_MODE_FILTER = 2
_SECCOMP = {"x86_64": 317, "aarch64": 277}
_SECCOMP_SET_MODE_FILTER, _SECCOMP_FILTER_FLAG_TSYNC = 1, 1
_CAPABILITY_VERSION_3 = 0x20080522
_MS_REC, _MS_PRIVATE, _MS_NOSUID, _MS_NODEV, _MS_NOEXEC = 0x4000, 1 << 18, 2, 4, 8
_SIOCGIFFLAGS, _SIOCSIFFLAGS, _IFF_UP = 0x8913, 0x8914, 1

_libc = ctypes.CDLL(None, use_errno=True)


def _check(result: int, what: str) -> None:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")


def unshare(namespaces: int) -> None:
    """Move this process into new namespaces of its own (unshare(2))."""
    _check(_libc.unshare(namespaces), "unshare")


def _prctl(option: int, value: int = 0) -> None:
    """Change a property of this process (prctl(2))."""
    _check(
        _libc.prctl(option, ctypes.c_ulong(value), ctypes.c_ulong(0), ctypes.c_ulong(0), ctypes.c_ulong(0)),
        f"prctl {option}",
    )


def filter_system_calls(program: bytes, *, every_thread: bool = False) -> None:
    """Install a seccomp filter for all later system calls of this thread, the threads that it starts, and its children.

    Args:
        program: Instructions of 8 bytes each (linux/filter.h, struct sock_filter). If there are none, no filter is
            installed, but the process still loses the ability to gain rights by executing a program (no_new_privs).
        every_thread: True to install it for the other threads of this process, too (seccomp(2)).
    """
    _prctl(_PR_SET_NO_NEW_PRIVS, 1)
    if not program:
        return
    code = ctypes.create_string_buffer(program, len(program))
    head = struct.pack("@HxxxxxxP", len(program) // 8, ctypes.addressof(code))
    if every_thread:
        call = ctypes.c_long(_SECCOMP[platform.machine()])
        flags = (_SECCOMP_SET_MODE_FILTER, _SECCOMP_FILTER_FLAG_TSYNC)
        # A positive result is the number of a thread that could not be given the filter.
        result = -abs(_libc.syscall(call, *flags, ctypes.c_char_p(head)))
    else:
        result = _libc.prctl(PR_SET_SECCOMP, _SECCOMP_MODE_FILTER, ctypes.c_char_p(head), 0, 0)
    _check(result, "seccomp")


def leave_the_host() -> None:
    """Enter a network with only a loopback interface, and a private mount namespace.

    This process then has full rights over these two namespaces, and over nothing else.
    """
    user, group = os.geteuid(), os.getegid()
    unshare(CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWNS)
    # In the new user namespace, the only user and the only group of this process get the number 0.
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"0 {user} 1")
    Path("/proc/self/gid_map").write_text(f"0 {group} 1")
    _bring_loopback_up()


def mount_tmpfs(place: Path, size: int, inodes: int) -> None:
    """Mount an empty file system in memory, visible only in this process's mount namespace.

    Args:
        place: An existing folder.
        size: The maximum number of bytes in the file system.
        inodes: The maximum number of files, folders and links in it.
    """
    _check(_libc.mount(b"none", b"/", None, ctypes.c_ulong(_MS_REC | _MS_PRIVATE), None), "mount")
    options = f"size={size},nr_inodes={inodes},mode=0755".encode()
    flags = ctypes.c_ulong(_MS_NOSUID | _MS_NODEV)
    _check(_libc.mount(b"tmpfs", os.fsencode(place), b"tmpfs", flags, options), f"mount {place}")


def mount_terminals(place: Path, most: int) -> None:
    """Mount an empty file system of pseudo-terminals.

    Args:
        place: An existing folder.
        most: The maximum number of terminals at the same time. It is limited because the machine has only a few
            thousand for all such file systems together.
    """
    options = f"newinstance,ptmxmode=0666,mode=620,max={most}".encode()
    flags = ctypes.c_ulong(_MS_NOSUID | _MS_NOEXEC)
    _check(_libc.mount(b"devpts", os.fsencode(place), b"devpts", flags, options), f"mount {place}")


def _bring_loopback_up() -> None:
    """Bring up ``lo``, the only interface of a new network namespace, which is down at first."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sH14x", b"lo", 0)
        flags = struct.unpack("16sH14x", fcntl.ioctl(any_socket, _SIOCGIFFLAGS, request))[1]
        fcntl.ioctl(any_socket, _SIOCSIFFLAGS, struct.pack("16sH14x", b"lo", flags | _IFF_UP))
