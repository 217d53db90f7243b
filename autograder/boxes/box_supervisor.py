"""The supervisor of one submission's boxes: it makes and ends them, and owns their network and their scratch.

The scratch is the file system in memory to which the boxes write. The supervisor is forked by a separate fork server
(:mod:`autograder.boxes.fork_server`), which has few imports. It enters new user, network and mount namespaces, in which
bubblewrap then makes the boxes. Each box gets a further user namespace, because otherwise a process in a box would have
rights over the network. When the connection to the executor is lost, for whatever reason, the supervisor kills all
boxes and exits.

The executor sends ``open`` (once), ``start`` (for a box or a command) and ``kill``. The supervisor answers ``opened``,
``started``, ``ended`` or ``failed``.
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

from autograder.boxes.box_connection import Channel, ChannelClosed, close_all
from autograder.boxes.process_isolation import leave_the_host, mount_terminals, mount_tmpfs, take_limits
from autograder.boxes.seccomp_filter import filter_for_boxes
from autograder.boxes.visible_host import ETC, ETC_FOLDERS, TERMINALS, etc_files
from autograder.process_trees import die_with_parent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


_SCRATCH_FOLDERS = ("home", "tmp", "shm", "work")
"""The folders in the scratch, each of which a box sees at another path, such as ``shm`` at ``/dev/shm``."""

_MOST_TERMINALS = 32
"""The maximum number of terminals. For example, a line of a notebook that begins with ``!`` uses one while it runs."""


def prepare() -> None:
    """Read the files for every box's ``/etc`` once, before the forks. Supervisors need no other preparation."""
    etc_files()


def run(channel: Channel) -> None:
    """Serve one submission until the executor disconnects."""
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
    """The bubblewrap process outside the box. It ends after the first process of the box, which ends after all others
    of the box.
    """
    end: int
    """The pidfd of bubblewrap."""
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
        """Carry out the executor's messages, and report which boxes have ended."""
        while True:
            watched: list[Any] = [self._channel, *(started.end for started in self._started.values())]
            ready, _, _ = select.select(watched, [], [])
            for name, started in list(self._started.items()):
                if started.end in ready:
                    self._channel.send({"say": "ended", "name": name, "status": self._reap(name)})
            if self._channel in ready:
                message, descriptors = self._channel.receive()
                try:
                    self._obey(message, descriptors)
                except (OSError, ValueError) as error:
                    self._channel.send({"say": "failed", "why": str(error)})
                finally:
                    close_all(descriptors)

    def end_all(self) -> None:
        """Kill every box and wait until none of its processes is alive."""
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
        leave_the_host()
        die_with_parent()  # again, because entering the user namespace has cleared this setting
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
        """Start a box with bubblewrap.

        If the message has a command, the descriptors that came with it are the command's standard input, output and
        error. If it has none, the box stays empty until a process enters, and lives until it is killed.
        """
        if name in self._started:
            raise ValueError(f"a box named {name} already exists")
        info, writing = os.pipe()
        # Start the command in a separate session, because Ctrl-C must reach its process group, but not bubblewrap.
        words = [*arguments, "--new-session", "--info-fd", str(writing)]
        words, kept = bubblewrap(words, hidden_memory=hidden_memory)
        kept.append(writing)

        idle = not command
        try:
            process = subprocess.Popen(
                [*words, *(command or ("/bin/cat",))],
                env={},
                stdin=subprocess.PIPE if idle else descriptors[0],
                stdout=subprocess.PIPE if idle else descriptors[1],
                stderr=subprocess.STDOUT if idle else descriptors[2],
                pass_fds=kept,
                # preexec_fn is safe, because this process has no other threads.
                preexec_fn=lambda: take_limits(cgroups, rlimits or {}),
                start_new_session=True,
            )
        finally:
            close_all(kept)
        started = self._started[name] = _Started(process, os.pidfd_open(process.pid))
        with open(info, "rb") as told:  # noqa: PTH123 (a descriptor)
            text = told.read()
        first = json.loads(text)["child-pid"] if text else 0
        if first:
            with contextlib.suppress(ProcessLookupError):  # the command has ended already
                started.first = os.pidfd_open(first)
        if not idle:
            self._tell_started(name, first)
            return
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.write(b"\n")
            process.stdin.flush()
        assert process.stdout is not None
        # The program that waits in an empty box echoes what is sent to it, so an echo means that the box is complete.
        with process.stdout as said:
            line = said.readline()
            if line != b"\n":
                why = (line + said.read()).decode(errors="replace").strip()
                self._reap(name)
                raise ValueError(f"bubblewrap made no box: {why[-500:]}")
        self._tell_started(name, first)

    def _tell_started(self, name: str, first: int) -> None:
        """Send a pidfd of the box's first process, which another process uses to enter the box."""
        pidfd = self._started[name].first
        self._channel.send({"say": "started", "name": name, "pid": first}, [pidfd] if pidfd >= 0 else [])

    def _reap(self, name: str) -> int:
        """Wait until a box ends, and return its exit code."""
        started = self._started.pop(name)
        status = started.process.wait()
        close_all([started.end, *([started.first] if started.first >= 0 else [])])
        if started.process.stdin is not None:
            with contextlib.suppress(OSError):
                started.process.stdin.close()
        return status


def furnish(place: Path, size: int, inodes: int) -> None:
    """Mount the scratch, visible only in this process's mount namespace, and make the folders of every box in it.

    Args:
        place: An existing folder.
        size: The maximum number of bytes in the scratch.
        inodes: The maximum number of files, folders and links in the scratch.
    """
    mount_tmpfs(place, size, inodes)
    for name in (*_SCRATCH_FOLDERS, TERMINALS):
        (place / name).mkdir()
    mount_terminals(place / TERMINALS, _MOST_TERMINALS)
    for name in ETC_FOLDERS:
        (place / ETC / name).mkdir(parents=True)
    for name, data in etc_files().items():
        (place / ETC / name).write_bytes(data)


def bubblewrap(arguments: Sequence[str], *, hidden_memory: bool) -> tuple[list[str], list[int]]:
    """Return the beginning of bubblewrap's command line, and the file descriptors that bubblewrap needs.

    The caller appends the command that runs in the box, and starts it with an empty environment, because a box sees
    that of its first process.

    Args:
        arguments: The description of the box (:func:`autograder.boxes.visible_host.box_arguments`).
        hidden_memory: True to allow memory that belongs to no process; see
            :func:`autograder.boxes.seccomp_filter.filter_for_boxes`.

    Returns:
        The words, and the descriptors that the command must inherit. The caller closes them.
    """
    kept = []
    seccomp = filter_for_boxes(hidden_memory=hidden_memory)
    if seccomp:
        kept.append(_file_with(seccomp))
        arguments = [*arguments, "--seccomp", str(kept[-1])]
    # The arguments are passed in a file, because a box sees the command line of its first process, which would name
    # folders of the host.
    kept.append(_file_with(b"".join(os.fsencode(word) + b"\0" for word in arguments)))
    return [shutil.which("bwrap") or "bwrap", "--args", str(kept[-1]), "--"], kept


def _file_with(data: bytes) -> int:
    """Return a descriptor of an anonymous file with this content, positioned at its start."""
    descriptor = os.memfd_create("for-bubblewrap")
    os.write(descriptor, data)
    os.lseek(descriptor, 0, os.SEEK_SET)
    return descriptor
