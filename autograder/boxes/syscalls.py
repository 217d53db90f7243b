"""System calls that Python does not offer, as functions that raise OSError.

The numbers come from Linux's headers: linux/sched.h, linux/prctl.h, linux/capability.h, linux/sockios.h.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import platform
import socket
import struct
from pathlib import Path

CLONE_FILES = 0x00000400
CLONE_THREAD = 0x00010000
CLONE_NEWNS = 0x00020000
CLONE_NEWCGROUP = 0x02000000
CLONE_NEWUTS = 0x04000000
CLONE_NEWIPC = 0x08000000
CLONE_NEWUSER = 0x10000000
CLONE_NEWPID = 0x20000000
CLONE_NEWNET = 0x40000000

PR_SET_DUMPABLE = 4
PR_SET_SECCOMP = 22
PR_CAPBSET_DROP = 24
PR_SET_NO_NEW_PRIVS = 38
PR_CAP_AMBIENT = 47
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


def setns(descriptor: int, namespaces: int) -> None:
    """Enter namespaces of the process to which a pidfd belongs (setns(2), Linux 5.8 or later)."""
    _check(_libc.setns(descriptor, namespaces), "setns")


def prctl(option: int, value: int = 0) -> None:
    """Change a property of this process (prctl(2))."""
    _check(
        _libc.prctl(option, ctypes.c_ulong(value), ctypes.c_ulong(0), ctypes.c_ulong(0), ctypes.c_ulong(0)),
        f"prctl {option}",
    )


def drop_capabilities() -> None:
    """Give up every capability, for this process and every program that it executes."""
    last = int(Path("/proc/sys/kernel/cap_last_cap").read_text())
    for capability in range(last + 1):
        prctl(PR_CAPBSET_DROP, capability)
    prctl(PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL)
    header = struct.pack("=Ii", _CAPABILITY_VERSION_3, 0)
    _check(_libc.capset(header, bytes(24)), "capset")


def filter_system_calls(program: bytes, *, every_thread: bool = False) -> None:
    """Install a seccomp filter for all later system calls of this thread, the threads that it starts, and its children.

    Args:
        program: Instructions of 8 bytes each (linux/filter.h, struct sock_filter). If there are none, no filter is
            installed, but the process still loses the ability to gain rights by executing a program (no_new_privs).
        every_thread: True to install it for the other threads of this process, too (seccomp(2)).
    """
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    if not program:
        return
    code = ctypes.create_string_buffer(program, len(program))
    head = struct.pack("@HxxxxxxP", len(program) // 8, ctypes.addressof(code))
    if every_thread:
        call = ctypes.c_long(_SECCOMP[platform.machine()])
        flags = (_SECCOMP_SET_MODE_FILTER, _SECCOMP_FILTER_FLAG_TSYNC)
        result = -abs(
            _libc.syscall(call, *flags, ctypes.c_char_p(head))
        )  # a positive result is the number of a thread that could not be given the filter
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
