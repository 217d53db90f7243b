"""How a fork of a fork server enters a box: joins its namespaces, then gives up what a student must not have."""

from __future__ import annotations

import contextlib
import os
import resource
import select
import signal
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from autograder.boxes import syscalls
from autograder.boxes.cgroups import join, memberships
from autograder.boxes.channel import Channel, ChannelClosed, close_all
from autograder.boxes.seccomp_filter import filter_for_boxes, filter_for_readers
from autograder.process_trees import adopt_orphans, die_with_parent, end_descendants

Run = Callable[[Mapping[str, Any], Sequence[int]], None]
"""What a child runs: called with the request's ``call`` and its descriptors."""

_ALL_NAMESPACES = (
    syscalls.CLONE_NEWUSER | syscalls.CLONE_NEWNS | syscalls.CLONE_NEWPID | syscalls.CLONE_NEWNET
    | syscalls.CLONE_NEWIPC | syscalls.CLONE_NEWUTS
)  # fmt: skip


@dataclass(frozen=True)
class Entrance:
    """The settings with which a child starts.

    Attributes:
        cwd: The working folder, as a path inside the box.
        environment: All environment variables.
        boxed: True to enter the box whose first process's pidfd is the request's first descriptor. Otherwise the
            child stays outside, which only a course's own notebooks and ``--unsafe-no-sandbox`` do.
        cgroups: The ``cgroup.procs`` files to join, as paths outside the box.
        rlimits: Limits on each process, by their names in :mod:`resource`.
        hidden_memory: See :func:`autograder.boxes.seccomp_filter.filter_for_boxes`.
        call: What ``run`` is told.
        reader_seconds: Limit in seconds of processor time for a process that may only read its descriptors and write
            to them (:func:`autograder.boxes.seccomp_filter.filter_for_readers`); 0 for any other process.
    """

    cwd: str
    environment: Mapping[str, str]
    boxed: bool
    cgroups: Sequence[str] = ()
    rlimits: Mapping[str, int] = field(default_factory=dict)
    hidden_memory: bool = True
    call: Mapping[str, Any] = field(default_factory=dict)
    reader_seconds: int = 0


def enter(channel: Channel, run: Run) -> None:
    """Serve one request in the child of a fork server: fork into the box, then watch over the process there.

    The answer is ``{"pid": …}`` as the host counts, and when that process has ended ``{"status": …}``, its wait
    status. If the other end hangs up first, the process is killed.
    """
    die_with_parent()
    message, descriptors = channel.receive()
    entrance = Entrance(**message)
    # Opened here, while the paths are visible. Only the child joins, so that a box that is out of memory cannot take
    # this watching process with it.
    groups = memberships(entrance.cgroups)
    if entrance.boxed:
        syscalls.setns(descriptors[0], _ALL_NAMESPACES)
    else:
        # Without a PID namespace, daemons that a student's code starts become our children, and we end them.
        adopt_orphans()
    pid = os.fork()
    if pid == 0:
        channel.close()
        join(groups)
        _begin(entrance, descriptors, run)
    close_all([*descriptors, *groups])
    with contextlib.suppress(ChannelClosed):
        channel.send({"pid": pid})
    status = _end_of(pid, channel)
    if not entrance.boxed:
        end_descendants()
    with contextlib.suppress(ChannelClosed):
        channel.send({"status": status})


def _end_of(pid: int, channel: Channel) -> int:
    """Wait for the process to end, or kill it when the other end of the channel is gone."""
    end = os.pidfd_open(pid)
    watched: list[Any] = [end, channel]
    ready, _, _ = select.select(watched, [], [])
    if end not in ready:
        # No further message is expected: a readable channel means that the other end is gone.
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    return status


def _begin(entrance: Entrance, descriptors: Sequence[int], run: Run) -> None:
    """Run everything that the process in the box does after its fork."""
    code = 1
    try:
        os.setsid()
        apply_rlimits(entrance.rlimits)
        os.environ.clear()
        os.environ.update(entrance.environment)
        os.chdir(entrance.cwd)
        if entrance.boxed:
            close_all(descriptors[:1])
            descriptors = descriptors[1:]
            filters = filter_for_boxes(hidden_memory=entrance.hidden_memory)
            give_up_rights(b"" if entrance.reader_seconds else filters)
        # Given up rights take this away (prctl(2)), so it comes after them. Our parent is in another PID namespace.
        die_with_parent()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if entrance.reader_seconds:
            _become_a_reader(entrance.reader_seconds)
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


def give_up_rights(filters: bytes) -> None:
    """No capability, none to be had by executing anything, and the filter of system calls."""
    syscalls.drop_capabilities()
    syscalls.filter_system_calls(filters)
    # A process that changed its rights does not own its /proc/self any more, which programs read.
    syscalls.prctl(syscalls.PR_SET_DUMPABLE, 1)


def _become_a_reader(seconds: int) -> None:
    """Take the limit on processor time and the filter of readers, with which SIGXCPU cannot be caught.

    SIGXCPU comes a second before SIGKILL, so that it tells the limit from a machine that is out of memory.
    """
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    syscalls.filter_system_calls(filter_for_readers())


def take_limits(cgroups: Sequence[str], rlimits: Mapping[str, int]) -> None:
    """Apply the limits of a box to the process that is about to become bubblewrap."""
    join(memberships(cgroups))
    apply_rlimits(rlimits)


def apply_rlimits(limits: Mapping[str, int]) -> None:
    """Set limits of this process and its children, as far as the system allows."""
    for name, value in limits.items():
        kind = getattr(resource, name)
        _, hard = resource.getrlimit(kind)
        wanted = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (wanted, wanted))
