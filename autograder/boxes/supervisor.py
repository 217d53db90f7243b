"""The supervisor of one submission's boxes: it owns their network namespace and their scratch, and ends them.

Forked from a fork server of its own (:mod:`autograder.boxes.fork_server`), which has imported almost nothing. It leaves
for a user, a network and a mount namespace of its own, from where bubblewrap makes the boxes. Each box gets a
further user namespace, so that nobody in a box has a right over the network. When the connection to the worker is
lost, however the worker ended, the supervisor kills all boxes and goes.

Words of the worker: ``open`` (once), ``start`` (a box or a command), ``kill``. Words of the supervisor: ``opened``,
``started``, ``ended``, ``failed``.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.boxes import syscalls
from autograder.boxes.channel import Channel, ChannelClosed, close_all
from autograder.boxes.entering import take_limits
from autograder.boxes.mounts import ETC, ETC_FOLDERS, TERMINALS, etc_files
from autograder.boxes.seccomp_filter import filter_for_boxes
from autograder.process_trees import die_with_parent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

SCRATCH_FOLDERS = ("home", "tmp", "shm", "work")
"""The folders in the scratch; a box sees each of them at another path."""

MOST_TERMINALS = 32
"""A line with an exclamation mark takes one while it runs."""


def prepare() -> None:
    """Everything is imported above; what every box's ``/etc`` holds is read once."""
    etc_files()


def run(channel: Channel) -> None:
    """Serve one submission until its worker hangs up."""
    die_with_parent()
    supervisor = _Supervisor(channel)
    try:
        supervisor.serve()
    except ChannelClosed:
        pass
    finally:
        supervisor.end_all()


@dataclass
class _Started:
    process: subprocess.Popen[bytes]
    """bubblewrap outside of the box. It ends when the first process of the box has, and with that one all have."""
    end: int
    """Its pidfd."""
    first: int = -1
    """The pidfd of the first process in the box."""

    def kill(self) -> None:
        if self.first >= 0:
            signal.pidfd_send_signal(self.first, signal.SIGKILL)
        else:
            self.process.kill()


class _Supervisor:
    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._started: dict[str, _Started] = {}

    def serve(self) -> None:
        """Do what the worker says, and tell it what has ended."""
        while True:
            watched: list[Any] = [self._channel, *(started.end for started in self._started.values())]
            ready, _, _ = select.select(watched, [], [])
            for name, started in list(self._started.items()):
                if started.end in ready:
                    self._ended(name)
            if self._channel in ready:
                message, descriptors = self._channel.receive()
                try:
                    self._obey(message, descriptors)
                except (OSError, ValueError) as error:
                    self._channel.send({"say": "failed", "why": str(error)})
                finally:
                    close_all(descriptors)

    def end_all(self) -> None:
        """Kill every box and wait until none of its processes lives."""
        for started in self._started.values():
            with contextlib.suppress(ProcessLookupError):
                started.kill()
        for name in list(self._started):
            self._reap(name)

    def _obey(self, message: dict[str, Any], descriptors: Sequence[int]) -> None:
        match message.pop("say"):
            case "open":
                self._open(**message)
            case "start":
                self._start(descriptors=descriptors, **message)
            case "kill":
                if message["name"] in self._started:
                    self._started[message["name"]].kill()

    def _open(self, scratch: str, size: int, inodes: int, files: str) -> None:
        syscalls.leave_the_host()
        die_with_parent()  # taken away by the change of rights
        syscalls.bring_loopback_up()
        place = Path(scratch)
        furnish(place, size, inodes)
        if files:
            shutil.copytree(files, place / "work", dirs_exist_ok=True)
        self._channel.send({"say": "opened"})

    def _start(
        self,
        name: str,
        arguments: Sequence[str],
        command: Sequence[str],
        descriptors: Sequence[int],
        *,
        cgroups: Sequence[str] = (),
        rlimits: Mapping[str, int] | None = None,
        hidden_memory: bool = True,
    ) -> None:
        """Let bubblewrap start a box.

        Without a command the box stays empty until somebody enters it, and lives until it is killed. With one, its
        standard input, output and error are the descriptors that came with the message.
        """
        if name in self._started:
            raise ValueError(f"there is a box named {name} already")
        info, writing = os.pipe()
        # A session of its own: Ctrl-C is for the command and its process group, and not for bubblewrap.
        words = [*arguments, "--new-session", "--info-fd", str(writing)]
        words, kept = bubblewrap(words, hidden_memory=hidden_memory)
        kept.append(writing)

        idle = not command
        try:
            process = subprocess.Popen(
                [*words, *(command or ("/bin/cat",))],
                stdin=subprocess.PIPE if idle else descriptors[0],
                stdout=subprocess.PIPE if idle else descriptors[1],
                stderr=subprocess.STDOUT if idle else descriptors[2],
                pass_fds=kept,
                preexec_fn=lambda: take_limits(cgroups, rlimits or {}),  # this process has no thread
                start_new_session=True,
            )
        finally:
            close_all(kept)
        started = self._started[name] = _Started(process, os.pidfd_open(process.pid))
        with open(info, "rb") as told:  # noqa: PTH123 (a descriptor)
            text = told.read()
        first = json.loads(text)["child-pid"] if text else 0
        if first:
            with contextlib.suppress(ProcessLookupError):  # a command that has ended at once
                started.first = os.pidfd_open(first)
        if not idle:
            self._tell_started(name, first)
            return
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.write(b"\n")
            process.stdin.flush()
        assert process.stdout is not None
        # The program that waits in an empty box repeats what is sent to it: an answer means that the box is complete.
        with process.stdout as said:
            line = said.readline()
            if line != b"\n":
                why = (line + said.read()).decode(errors="replace").strip()
                self._reap(name)
                raise ValueError(f"bubblewrap made no box: {why[-500:]}")
        self._tell_started(name, first)

    def _tell_started(self, name: str, first: int) -> None:
        """Hand over the pidfd of the first process in the box: with it one enters the box."""
        pidfd = self._started[name].first
        self._channel.send({"say": "started", "name": name, "pid": first}, [pidfd] if pidfd >= 0 else [])

    def _ended(self, name: str) -> None:
        self._channel.send({"say": "ended", "name": name, "status": self._reap(name)})

    def _reap(self, name: str) -> int:
        """Wait for a box's end."""
        started = self._started.pop(name)
        status = started.process.wait()
        close_all([started.end, *([started.first] if started.first >= 0 else [])])
        if started.process.stdin is not None:
            with contextlib.suppress(OSError):
                started.process.stdin.close()
        return status


def furnish(place: Path, size: int, inodes: int) -> None:
    """Mount the scratch and make in it what every box has, in this process's mount namespace only.

    Args:
        place: An existing folder.
        size: Bytes that the scratch can hold.
        inodes: Files, folders and links that it can hold.
    """
    syscalls.mount_tmpfs(place, size, inodes)
    for name in (*SCRATCH_FOLDERS, TERMINALS):
        (place / name).mkdir()
    syscalls.mount_terminals(place / TERMINALS, MOST_TERMINALS)
    for name in ETC_FOLDERS:
        (place / ETC / name).mkdir(parents=True)
    for name, data in etc_files().items():
        (place / ETC / name).write_bytes(data)


def bubblewrap(arguments: Sequence[str], *, hidden_memory: bool) -> tuple[list[str], list[int]]:
    """The beginning of a command line, which a command is to follow, and the descriptors that it needs.

    Args:
        arguments: What the box is like (:func:`autograder.boxes.mounts.box_arguments`).
        hidden_memory: See :func:`autograder.boxes.seccomp_filter.filter_for_boxes`.

    Returns:
        The words, and descriptors to be inherited, which the caller closes.
    """
    kept = []
    seccomp = filter_for_boxes(hidden_memory=hidden_memory)
    if seccomp:
        kept.append(_file_with(seccomp))
        arguments = [*arguments, "--seccomp", str(kept[-1])]
    # In a file, because a box sees the command line of its first process, and folders of the host are in it.
    kept.append(_file_with(b"".join(os.fsencode(word) + b"\0" for word in arguments)))
    return ["bwrap", "--args", str(kept[-1]), "--"], kept


def _file_with(data: bytes) -> int:
    """A descriptor of an anonymous file with this content, at its beginning."""
    descriptor = os.memfd_create("for-bubblewrap")
    os.write(descriptor, data)
    os.lseek(descriptor, 0, os.SEEK_SET)
    return descriptor
