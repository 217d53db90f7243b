"""Boxes of one submission: made, entered, used for a command, ended.

.. code-block:: python

    with Enclosure(addresses.keepers, folder, files={"data.csv": b"1,2"}) as enclosure:
        box = enclosure.box("student", [Bind(folder_of_the_socket, Path("/run/judge"))])
        done = enclosure.run(["ros2", "run", "my_robot_pkg", "talker"], limit=30.0)

All boxes of an enclosure share one network namespace with nothing in it but the loopback interface: their ROS
nodes meet each other and nobody else, whatever the domain. When the enclosure is closed, or its process is killed,
no process of any of its boxes is left and its scratch is gone.
"""

from __future__ import annotations

import functools
import os
import select
import shutil
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from autograder.boxes.channel import Channel, ChannelClosed, close_all
from autograder.boxes.forkserver import KEEPER_MODULE, WarmProcess
from autograder.boxes.scratch import write_files
from autograder.boxes.view import HOME, WORK, Bind, box_arguments
from autograder.boxes.warm import BESIDE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import TracebackType

    from autograder.boxes.guards import BoxGuard

__all__ = ["Bind", "Box", "Enclosure", "Finished", "NoSandbox", "why_impossible"]

_ANSWER_SECONDS = 30.0
SCRATCH_BYTES = 1_000_000_000
SCRATCH_INODES = 200_000
OUTPUT_BYTES = 1_000_000


class NoSandbox(RuntimeError):
    """There is no box here; the message says why, and what to do about it."""


@dataclass(frozen=True)
class Box:
    """A box that is there.

    Attributes:
        name: Its name in its enclosure.
        pid: Its first process, as the host counts.
        pidfd: Stands for that process: hand it to a warm process to enter the box. Belongs to the enclosure.
    """

    name: str
    pid: int
    pidfd: int


@dataclass(frozen=True)
class Finished:
    """How a command in a box ended.

    Attributes:
        returncode: As :class:`subprocess.Popen` has it: the exit code; negative for a signal. None where it was
            ended at its limit.
        output: What it said on standard output and standard error, in that order of arrival, at most the allowed
            number of bytes.
        cut: Whether it said more.
        seconds: Wall time.
    """

    returncode: int | None
    output: bytes
    cut: bool
    seconds: float

    @property
    def timed_out(self) -> bool:
        """Whether it was ended at its limit."""
        return self.returncode is None


class Enclosure:
    """The network, the scratch and the boxes of one submission. Threads take turns.

    Args:
        keepers: Where the warm process of keepers listens.
        folder: Ours alone and short-lived; nothing of it is seen in a box but what is bound. Made where it is not.
        files: Files to lie in the notebook's folder, by relative path.
        scratch_bytes: What all files that the boxes write may have together.
        scratch_inodes: How many files, folders and links there may be.
        guard: Holds the limits of the commands; they share them with whatever else it guards.

    Raises:
        NoSandbox: The keeper could not make the namespaces.
    """

    def __init__(
        self,
        keepers: str,
        folder: Path,
        *,
        files: Mapping[str, bytes] | None = None,
        scratch_bytes: int = SCRATCH_BYTES,
        scratch_inodes: int = SCRATCH_INODES,
        guard: BoxGuard | None = None,
    ) -> None:
        self._folder = folder
        self._scratch = folder / "scratch"
        self._scratch.mkdir(parents=True)
        self._guard = guard
        self._boxes: dict[str, Box] = {}
        self._ended: dict[str, int] = {}
        self._commands = 0
        self._turn = threading.RLock()
        self._channel = Channel.to(keepers)
        try:
            self._ask(
                "opened",
                say="open",
                scratch=str(self._scratch),
                size=scratch_bytes,
                inodes=scratch_inodes,
                files=str(write_files(files, folder / "files")) if files else "",
            )
        except BaseException:
            self._channel.close()
            raise

    def box(self, name: str, binds: Sequence[Bind] = (), *, scratch: bool = True) -> Box:
        """Make an empty box, for a warm process's child to enter.

        Args:
            name: Not yet used in this enclosure.
            binds: What it is to see beside the system, Python and the course's package.
            scratch: Give it the enclosure's scratch; else it has a small one of its own.

        Raises:
            NoSandbox: It could not be made.
        """
        message, descriptors = self._ask(
            "started",
            say="start",
            name=name,
            arguments=box_arguments(self._scratch, binds, scratch_visible=scratch),
            command=[],
        )
        box = Box(name, message["pid"], descriptors[0])
        self._boxes[name] = box
        return box

    def run(
        self,
        command: Sequence[str],
        *,
        limit: float,
        binds: Sequence[Bind] = (),
        environment: Mapping[str, str] | None = None,
        cwd: Path = WORK,
        output_bytes: int = OUTPUT_BYTES,
        scratch: bool = True,
        rlimits: Mapping[str, int] | None = None,
    ) -> Finished:
        """Run a command in a box of its own, in the submission's network namespace, until it ends.

        When this returns no process of that box is alive, daemons included.

        Args:
            command: Program and arguments, as they are called in the box.
            limit: Seconds of wall time; then the whole box is killed.
            binds: What the box is to see beside the system, Python and the course's package.
            environment: Its whole environment; :func:`autograder.boxes.environment.box_environment` where None.
            cwd: Where it starts.
            output_bytes: How much of its output is kept.
            scratch: See :meth:`box`. Two commands with the scratch see each other's files.
            rlimits: Limits of each process, by the name that :mod:`resource` gives them, beside the guard's.

        Raises:
            NoSandbox: The box could not be made.
        """
        with self.start(
            command, binds=binds, environment=environment, cwd=cwd, output_bytes=output_bytes, scratch=scratch,
            rlimits=rlimits,
        ) as running:  # fmt: skip
            return running.wait(limit)

    def start(
        self,
        command: Sequence[str],
        *,
        binds: Sequence[Bind] = (),
        environment: Mapping[str, str] | None = None,
        cwd: Path = WORK,
        output_bytes: int = OUTPUT_BYTES,
        scratch: bool = True,
        rlimits: Mapping[str, int] | None = None,
    ) -> Running:
        """Start a command in a box of its own; leaving the result's context ends it. See :meth:`run`."""
        from autograder.boxes.environment import box_environment

        with self._turn:
            self._commands += 1
            name = f"command {self._commands}"
        words = box_arguments(self._scratch, binds, scratch_visible=scratch)
        for variable, value in (box_environment() if environment is None else environment).items():
            words += ["--setenv", variable, value]
        reading, writing = os.pipe()
        nothing = os.open(os.devnull, os.O_RDONLY)
        try:
            message, descriptors = self._ask(
                "started",
                [nothing, writing, writing],
                say="start",
                name=name,
                arguments=[*words, "--chdir", str(cwd)],
                command=list(command),
                cgroups=self._guard.cgroups if self._guard else [],
                rlimits={**(self._guard.rlimits if self._guard else {}), **(rlimits or {})},
                hidden_memory=self._guard.hidden_memory if self._guard else True,
            )
        except BaseException:
            os.close(reading)
            raise
        finally:
            close_all([nothing, writing])
        close_all(descriptors)
        return Running(self, name, message["pid"], reading, output_bytes)

    def end(self, name: str) -> int:
        """Kill a box and wait until no process of it is alive.

        Returns:
            The exit code of bubblewrap: that of the command, 128 and more for a signal.
        """
        with self._turn:
            if name not in self._ended:
                self._channel.send({"say": "kill", "name": name})
            return self.wait_end(name, _ANSWER_SECONDS)

    def wait_end(self, name: str, within: float) -> int:
        """Wait until a box has ended of its own.

        Raises:
            ChannelClosed: It did not end in time, or the keeper is gone.
        """
        with self._turn:
            while name not in self._ended:
                self._take(*self._channel.receive(within))
            box = self._boxes.pop(name, None)
            if box is not None:
                os.close(box.pidfd)
            return self._ended[name]

    def close(self) -> None:
        """End all boxes and wait until none of their processes is alive; may be called twice."""
        try:
            for name in list(self._boxes):
                self.end(name)
        except ChannelClosed:
            pass  # the keeper is gone, and with it what it kept
        finally:
            self._channel.close()
            for box in self._boxes.values():
                os.close(box.pidfd)
            self._boxes.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _ask(
        self, expected: str, descriptors: Sequence[int] = (), **message: Any
    ) -> tuple[dict[str, Any], list[int]]:
        try:
            with self._turn:
                self._channel.send(message, descriptors)
                while True:
                    answer, received = self._channel.receive(_ANSWER_SECONDS)
                    if answer["say"] == expected:
                        return answer, received
                    self._take(answer, received)
        except ChannelClosed as error:
            raise NoSandbox(f"the keeper of the boxes is gone: {error}") from error

    def _take(self, message: dict[str, Any], descriptors: Sequence[int]) -> None:
        close_all(descriptors)
        if message["say"] == "ended":
            self._ended[message["name"]] = message["status"]
        elif message["say"] == "failed":
            raise NoSandbox(message["why"])


class Running:
    """A command that runs in a box; leaving the context ends it and all that it has started."""

    def __init__(self, enclosure: Enclosure, name: str, pid: int, output: int, most: int) -> None:
        self._enclosure, self._name, self._output, self._most = enclosure, name, output, most
        self._began = time.monotonic()
        self._kept = bytearray()
        self._cut = False
        self.pid = pid
        """The first process of the box, as the host counts."""

    def fileno(self) -> int:
        """Readable when it has said something, or when it and all that hold its output have ended."""
        return self._output

    def read(self, within: float) -> bool:
        """Take up what it says; False once it has ended.

        Args:
            within: Seconds to wait for something to read.
        """
        if not select.select([self._output], [], [], max(0.0, within))[0]:
            return True
        piece = os.read(self._output, 1 << 16)
        room = self._most - len(self._kept)
        self._kept += piece[:room]
        self._cut = self._cut or len(piece) > room
        return bool(piece)

    @property
    def said(self) -> bytes:
        """What it has said so far, as far as it was taken up and is kept."""
        return bytes(self._kept)

    def wait(self, limit: float) -> Finished:
        """Wait until it ends, and end it at its limit.

        Args:
            limit: Seconds of wall time from its start.
        """
        deadline = self._began + limit
        running = True
        while running and time.monotonic() < deadline:
            running = self.read(deadline - time.monotonic())
        if running:
            self._enclosure.end(self._name)
            return self._finished(None)
        status = self._enclosure.wait_end(self._name, _ANSWER_SECONDS)
        return self._finished(status if status < 128 else 128 - status)

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        if self._output >= 0:
            self._enclosure.end(self._name)
            os.close(self._output)
            self._output = -1

    def _finished(self, returncode: int | None) -> Finished:
        return Finished(returncode, self.said, self._cut, time.monotonic() - self._began)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()


@functools.cache
def why_impossible() -> str:
    """Why no sandbox is possible here and what to do about it, in one sentence; empty where one is.

    Found out by making one.
    """
    if shutil.which("bwrap") is None:
        return (
            "bubblewrap is not installed: ./course setup installs it as root on Debian or Ubuntu, "
            "otherwise type: sudo apt-get install -y bubblewrap"
        )
    with tempfile.TemporaryDirectory(prefix="box-") as name:
        folder = Path(name)
        keepers = WarmProcess(BESIDE, KEEPER_MODULE, folder / "keepers")
        try:
            with Enclosure(keepers.address, folder / "try") as enclosure:
                done = enclosure.run(["/bin/sh", "-c", f"test -d {HOME}"], limit=20.0)
            return (
                ""
                if done.returncode == 0
                else f"a program in a box ended with {done.output.decode()[-300:]!r}"
            )
        except (NoSandbox, OSError) as error:
            return f"{_reason(str(error))} ({error})"
        finally:
            keepers.stop()


def _reason(error: str) -> str:
    """What a refusal mostly means."""
    apparmor = Path("/proc/sys/kernel/apparmor_restrict_unprivileged_userns")
    if os.geteuid() != 0 and apparmor.exists() and apparmor.read_text().strip() == "1":
        return (
            "this system keeps user namespaces from ordinary users: "
            "type sudo sysctl kernel.apparmor_restrict_unprivileged_userns=0, or grade as root"
        )
    if "unshare" in error or "namespace" in error:
        return (
            "this system or its container allows no user namespaces: set the sysctls user.max_user_namespaces and, "
            "where there is one, kernel.unprivileged_userns_clone, or start the container with "
            "--security-opt seccomp=unconfined"
        )
    return "no box could be made here"
