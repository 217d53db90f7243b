"""How a child of a fork server enters a box: it joins the box's namespaces, then gives up its rights."""

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
from autograder.boxes.box_connection import Channel, ChannelClosed, close_all
from autograder.boxes.cgroups import join, memberships
from autograder.boxes.seccomp_filter import filter_for_boxes, filter_for_readers
from autograder.process_trees import adopt_orphans, die_with_parent, end_descendants

Run = Callable[[Mapping[str, Any], Sequence[int]], None]
"""The function that a child runs, given the request's ``call`` and descriptors."""

_ALL_NAMESPACES = (
    syscalls.CLONE_NEWUSER | syscalls.CLONE_NEWNS | syscalls.CLONE_NEWPID | syscalls.CLONE_NEWNET
    | syscalls.CLONE_NEWIPC | syscalls.CLONE_NEWUTS
)  # fmt: skip


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
        syscalls.setns(descriptors[0], _ALL_NAMESPACES)
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
                syscalls.filter_system_calls(filter_for_readers())
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
    syscalls.drop_capabilities()
    syscalls.filter_system_calls(filters)
    # After a change of rights, a process cannot read its own /proc/self, as programs do, unless it is made dumpable.
    syscalls.prctl(syscalls.PR_SET_DUMPABLE, 1)


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
