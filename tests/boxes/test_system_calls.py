"""The filter of system calls, run by a little interpreter: also for machines that this one is not."""

from __future__ import annotations

import errno
import fcntl
import re
import socket
import struct
from pathlib import Path

import pytest

from autograder.boxes.process_isolation import PR_SET_DUMPABLE
from autograder.boxes.seccomp_filter import (
    _DESKS,
    _FUTEX,
    _READERS,
    ARCHITECTURES,
    CLONE_FILES,
    CLONE_NEWNET,
    CLONE_NEWUSER,
    PR_SET_SECCOMP,
    filter_for_boxes,
    filter_for_desks,
    filter_for_readers,
)

ALLOW, KILL, ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
HEADERS = {
    "x86_64": (Path("/usr/include/x86_64-linux-gnu/asm/unistd_64.h"), r"#define __NR_(\w+) (\d+)"),
    "aarch64": (Path("/usr/include/asm-generic/unistd.h"), r"#define __NR(?:3264)?_(\w+) (\d+)"),
}


def decide(machine: str, name: str | int, *arguments: int, audit: int = 0, hidden_memory: bool = True) -> int:
    """What the filter of boxes says to a call."""
    program = filter_for_boxes(machine=machine, hidden_memory=hidden_memory)
    return _says(program, machine, name, *arguments, audit=audit)


def _says(program_bytes: bytes, machine: str, name: str | int, *arguments: int, audit: int = 0) -> int:
    """What a filter says to a call (linux/seccomp.h, struct seccomp_data)."""
    known = ARCHITECTURES[machine]
    number = name if isinstance(name, int) else known.calls[name]
    data = struct.pack("=IIQ6Q", number, audit or known.audit, 0, *(*arguments, *[0] * 6)[:6])
    program = list(struct.iter_unpack("=HBBI", program_bytes))
    register = position = 0
    while True:
        code, yes, no, value = program[position]
        position += 1
        match code:
            case 0x20:
                (register,) = struct.unpack_from("=I", data, value)
            case 0x06:
                return int(value)
            case 0x15:
                position += yes if register == value else no
            case 0x35:
                position += yes if register >= value else no
            case 0x45:
                position += yes if register & value else no
            case 0x54:
                register &= value
            case _:
                raise AssertionError(f"not an instruction of these filters: {code:#x}")


NEEDLESS = (
    "ptrace mount unshare setns bpf inotify_init1 keyctl io_uring_setup io_setup "
    "userfaultfd kexec_load semget msgget mbind set_mempolicy set_mempolicy_home_node seccomp"
)
"""Calls that no honest program needs an answer to."""

machines = pytest.mark.parametrize("machine", sorted(ARCHITECTURES))


@machines
def test_what_needs_no_answer_is_refused(machine: str) -> None:
    for name in NEEDLESS.split():
        assert decide(machine, name) == ERRNO | errno.EPERM, name


@machines
def test_files_have_no_attributes(machine: str) -> None:
    for name in ("setxattr", "lsetxattr", "fsetxattr", "setxattrat"):
        assert decide(machine, name) == ERRNO | errno.EOPNOTSUPP, name


@machines
def test_everything_else_is_allowed(machine: str) -> None:
    refused = set(ARCHITECTURES[machine].calls.values())
    for number in (n for n in range(470) if n not in refused):
        assert decide(machine, number) == ALLOW, number


@machines
def test_clone_makes_threads_and_processes_and_no_namespaces(machine: str) -> None:
    thread, process = 0x3D0F00, 17
    assert decide(machine, "clone", thread) == decide(machine, "clone", process) == ALLOW
    assert decide(machine, "clone", process | CLONE_FILES) == ERRNO | errno.EPERM
    # /proc/PID/fd shows the table of open files of a process, so all of its threads have to share this table.
    assert decide(machine, "clone", thread & ~CLONE_FILES) == ERRNO | errno.EPERM
    assert decide(machine, "close_range", 3, 9, 2) == ERRNO | errno.EPERM
    assert decide(machine, "close_range", 3, 9, 4) == ALLOW
    for flag in (CLONE_NEWUSER, CLONE_NEWNET):
        assert decide(machine, "clone", process | flag) == ERRNO | errno.EPERM
    assert decide(machine, "clone3") == ERRNO | errno.ENOSYS


@machines
def test_sockets_of_the_network_and_of_unix_only(machine: str) -> None:
    for family in (socket.AF_UNIX, socket.AF_INET, socket.AF_INET6, 16):
        assert decide(machine, "socket", family) == ALLOW
    for family in (17, 38, 40):
        assert decide(machine, "socket", family) == ERRNO | errno.EAFNOSUPPORT
    for family in (socket.AF_INET, socket.AF_INET6):
        for protocol in (0, socket.IPPROTO_TCP, socket.IPPROTO_UDP):
            assert decide(machine, "socket", family, 1, protocol) == ALLOW
        for protocol in (socket.IPPROTO_UDPLITE, 132, 256, 262):  # SCTP, SMC and MPTCP
            assert decide(machine, "socket", family, 1, protocol) == ERRNO | errno.EPROTONOSUPPORT
    for protocol in range(1, 24):
        assert decide(machine, "socket", 16, 3, protocol) == ERRNO | errno.EPROTONOSUPPORT
    assert decide(machine, "socketpair", socket.AF_UNIX) == ALLOW
    assert decide(machine, "ioctl", 0, 0x5412) == ERRNO | errno.EPERM
    assert decide(machine, "ioctl", 0, 0x5413) == ALLOW


@machines
def test_no_program_for_the_kernel_is_made(machine: str) -> None:
    for option in (26, 50, 51, 52):  # SO_ATTACH_FILTER, SO_ATTACH_BPF, and those of SO_REUSEPORT
        assert decide(machine, "setsockopt", 3, socket.SOL_SOCKET, option) == ERRNO | errno.EPERM
    assert decide(machine, "setsockopt", 3, socket.IPPROTO_IPV6, socket.IPV6_V6ONLY) == ALLOW  # which is 26
    assert decide(machine, "setsockopt", 3, socket.SOL_SOCKET, socket.SO_REUSEPORT) == ALLOW
    assert decide(machine, "setsockopt", 3, socket.IPPROTO_TCP, 26) == ALLOW
    assert decide(machine, "prctl", PR_SET_SECCOMP) == ERRNO | errno.EPERM
    assert decide(machine, "prctl", PR_SET_DUMPABLE) == ALLOW


@machines
def test_what_linux_counts_for_a_user_or_for_all_of_the_machine_is_left_to_others(machine: str) -> None:
    """Pages locked by SO_ZEROCOPY (for a user), and flow labels of IPv6 (4,096 for all networks of a machine)."""
    assert decide(machine, "setsockopt", 3, socket.SOL_SOCKET, 60) == ERRNO | errno.EPERM
    assert decide(machine, "setsockopt", 3, socket.IPPROTO_IPV6, 32) == ERRNO | errno.EPERM


@machines
def test_pieces_of_memory_have_no_names(machine: str) -> None:
    assert decide(machine, "prctl", 0x53564D41, 0) == ERRNO | errno.EPERM  # PR_SET_VMA


@machines
def test_descriptors_are_arranged_and_files_locked_and_nobody_is_made_to_wait_for_a_file(
    machine: str,
) -> None:
    for command in range(1100):
        refused = command in (fcntl.F_SETLEASE, fcntl.F_NOTIFY, 1040)  # F_SETDELEG, since Linux 6.19
        refused = refused or command in (
            37,
            38,
        )  # F_OFD_SETLK and F_OFD_SETLKW: no box's /proc/locks shows whose
        assert decide(machine, "fcntl", 3, command) == (ERRNO | errno.EPERM if refused else ALLOW), command
    # The kernel takes the command as 32 bits, whatever stands above them.
    assert decide(machine, "fcntl", 3, 1 << 32 | fcntl.F_SETLEASE) == ERRNO | errno.EPERM
    assert decide(machine, "fcntl", 3, fcntl.F_SETLEASE << 32 | fcntl.F_GETFD) == ALLOW
    assert decide(machine, "fcntl", fcntl.F_SETLEASE, fcntl.F_GETFD, fcntl.F_SETLEASE) == ALLOW


@machines
def test_hidden_memory_only_where_it_is_counted(machine: str) -> None:
    for name in ("memfd_create", "shmget", "vmsplice"):
        assert decide(machine, name) == ALLOW
        assert decide(machine, name, hidden_memory=False) == ERRNO | errno.EPERM


@machines
def test_a_reader_reads_writes_has_memory_and_ends(machine: str) -> None:
    program = filter_for_readers(machine)
    allowed = {number for number in range(500) if _says(program, machine, number, 3, 1) == ALLOW}
    assert allowed == {*_READERS[machine].values(), _FUTEX[machine]}
    for operation in (0, 9, 128, 137):  # those that wait
        assert _says(program, machine, _FUTEX[machine], 3, operation) == ERRNO | errno.EPERM
    for name in ARCHITECTURES[machine].calls:
        assert _says(program, machine, name) != ALLOW, name
    assert _says(program, machine, 0, audit=0x40000003) == KILL


@machines
def test_a_desk_uses_its_connections_and_makes_none(machine: str) -> None:
    program = filter_for_desks(machine)
    allowed = {number for number in range(500) if _says(program, machine, number) == ALLOW}
    assert allowed == {*_READERS[machine].values(), *_DESKS[machine].values()}
    for name in (*ARCHITECTURES[machine].calls, "socket", "clone"):
        assert _says(program, machine, name) != ALLOW, name
    assert _says(program, machine, 0, audit=0x40000003) == KILL


@machines
def test_another_machines_calls_end_the_process(machine: str) -> None:
    assert decide(machine, 0, audit=0x40000003) == KILL  # 32-bit x86
    if ARCHITECTURES[machine].x32:
        assert decide(machine, 0x40000000 | 1) == ERRNO | errno.ENOSYS


@machines
def test_the_numbers_are_the_kernels(machine: str) -> None:
    header, pattern = HEADERS[machine]
    if not header.exists():
        pytest.skip(f"{header} is not installed")
    official = {name: int(number) for name, number in re.findall(pattern, header.read_text())}
    ours = {**ARCHITECTURES[machine].calls, **_READERS[machine], **_DESKS[machine], "futex": _FUTEX[machine]}
    assert {name: official[name] for name in ours if name in official} == {
        name: number for name, number in ours.items() if name in official
    }
    assert len([name for name in ours if name in official]) > 40


def test_a_machine_that_is_not_known_has_no_filter() -> None:
    assert filter_for_boxes(machine="riscv64") == filter_for_readers("riscv64") == b""
    assert filter_for_desks("riscv64") == b""
