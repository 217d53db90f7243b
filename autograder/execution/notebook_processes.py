"""Starts the processes of a notebook (kernel, desk and judge): in boxes, or without if the user asked for no sandbox.

Each of the two classes leaves no process behind.
"""

from __future__ import annotations

import contextlib
import itertools
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from autograder.boxes.boxed_processes import ForkedProcess
from autograder.boxes.limit_guards import BoxGuard, NoGuard
from autograder.boxes.process_isolation import Entrance
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.visible_host import (
    HOME,
    WORK,
    Bind,
    base_environment,
    box_environment,
    kernel_environment,
)
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.safe_files import write_files

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.boxes.fork_server import Addresses
    from autograder.boxes.run_limits import Limits
    from autograder.execution.kernel_channels import Channels

SHARED_FOLDER = Path("/run/judge")
"""The path, in the student's box, of the folder that the box shares with its grader."""
DESK_FOLDER = Path("/run/kernel")
"""The path, in the box of a kernel's desk, of the folder with the kernel's sockets."""
_STUDENT, _JUDGE = "student", "judge"
_PROGRAMS_SCRATCH_BYTES, _PROGRAMS_SCRATCH_FILES = 1_000_000, 1_000
"""The limits, in bytes and in files, of the scratch that the boxes of programs share. Only the supervisor writes there.
Each program writes its files into a small scratch of its own box.
"""


@dataclass(frozen=True)
class NotebookSetting:
    """The settings of the processes of one notebook.

    They include the judge's settings, because this part of the package does not import the judge.

    Attributes:
        folder: A folder that nothing else uses. Its path must be short, because it will contain Unix sockets.
        limits: The limits for the kernel and everything that it starts.
        files: The files next to the notebook.
        variables: More environment variables for the kernel.
        judges_variables: More environment variables for the judge.
        judges_folders: Folders that only a judge may see, such as the one with the reference outputs.
        programs: True to make a second network, for programs. Without boxes this changes nothing.
    """

    folder: Path
    limits: Limits
    files: Mapping[str, bytes] = field(default_factory=dict)
    variables: Mapping[str, str] = field(default_factory=dict)
    judges_variables: Mapping[str, str] = field(default_factory=dict)
    judges_folders: Sequence[Path] = ()
    programs: bool = False


class BoxedProcesses:
    """Starts the processes of a notebook in boxes, which are on one network or on two.

    The student's box and the judge's box share the notebook's network. Programs that the grader builds and starts for
    a check run on a second network, with another judge. The student's box cannot reach that network.

    Args:
        addresses: The addresses of the fork servers.

    Raises:
        NoSandbox: The namespaces could not be made.
    """

    def __init__(self, addresses: Addresses, setting: NotebookSetting) -> None:
        self._addresses, self._setting = addresses, setting
        self.folder, self.limits = setting.folder, setting.limits
        self._judges = itertools.count(1)
        self.shared = self.folder / "run"
        """The folder that the student's box sees, read-only, at the path ``SHARED_FOLDER``."""
        self.shared.mkdir()
        self.judge_socket = self.shared / _JUDGE
        """The path of the judge's socket, as the grader sees it."""
        self._variables = {**setting.variables, SOCKET_VARIABLE: str(SHARED_FOLDER / _JUDGE)}
        self.guard = BoxGuard(self.limits)
        with contextlib.ExitStack() as started:
            started.callback(self.guard.close)
            self.enclosure = started.enter_context(
                Enclosure(
                    addresses.supervisors, self.folder / "box", files=setting.files, guard=self.guard,
                    scratch_bytes=self.limits.scratch_bytes, scratch_inodes=self.limits.scratch_files,
                )
            )  # fmt: skip
            self.programs = self.enclosure if not setting.programs else started.enter_context(
                Enclosure(
                    addresses.supervisors, self.folder / "programs", guard=self.guard,
                    scratch_bytes=_PROGRAMS_SCRATCH_BYTES, scratch_inodes=_PROGRAMS_SCRATCH_FILES,
                )
            )  # fmt: skip
            self._open = started.pop_all()

    def abandon(self) -> None:
        """End all boxes, and do not wait. Any thread may call this. Threads that wait for a box see that it is lost."""
        for enclosure in {self.enclosure, self.programs}:
            enclosure.abandon()

    def start_kernel(self, channels: Channels) -> ForkedProcess:
        """Start the kernel: a child of the fork server enters the student's box."""
        box = self.enclosure.box(_STUDENT, [Bind(self.shared, SHARED_FOLDER)], guarded=True)
        self.guard.watch(box.pid)
        call = _request("kernel", channels, channels.folder)
        entrance = Entrance(str(WORK), box_environment(self._variables), boxed=True, call=call)
        descriptors = [channels.shell, channels.iopub, channels.log]
        return self.enclosure.enter(box, self._addresses.kernels, descriptors, entrance)

    def start_desk(self, channels: Channels) -> ForkedProcess:
        """Start the kernel's desk: another child of the same fork server enters a separate box."""
        box = self.enclosure.box("desk", [Bind(channels.folder, DESK_FOLDER)], scratch=False)
        entrance = _desk_entrance(channels, DESK_FOLDER, self.limits, boxed=True)
        return self.enclosure.enter(box, self._addresses.kernels, [channels.orders], entrance)

    def start_judge(self, listener: int, orders: int, *, of_programs: bool = False) -> ForkedProcess:
        """Start a judge: a child of the judges' fork server enters a box that is made for it.

        Args:
            listener: The socket that listens for the notebook.
            orders: The socket for the grader's orders.
            of_programs: True for the network of programs, False for the notebook's.
        """
        enclosure = self.programs if of_programs else self.enclosure
        name = f"{_JUDGE} {next(self._judges)}"
        box = enclosure.box(name, [Bind(path) for path in self._setting.judges_folders], scratch=False)
        environment = box_environment(self._setting.judges_variables)
        entrance = Entrance(str(HOME), environment, boxed=True, rlimits=self.limits.of_the_judge)
        return enclosure.enter(box, self._addresses.judges, [listener, orders], entrance)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()


class UnboxedProcesses:
    """Starts the processes of a notebook without boxes, with the rights of the user who grades.

    The course's own notebooks, and those of ``--unsafe-no-sandbox``, run in this way. The arguments are those of
    :class:`BoxedProcesses`.
    """

    def __init__(self, addresses: Addresses, setting: NotebookSetting) -> None:
        self._addresses, self._judges_variables = addresses, setting.judges_variables
        self.folder, self.limits = setting.folder, setting.limits
        self.guard = NoGuard()
        self.judge_socket = self.folder / _JUDGE
        """The path of the socket on which the judge listens."""
        self._started: list[ForkedProcess] = []
        self._cwd = write_files(setting.files, self.folder / "work")
        self._variables = {**setting.variables, SOCKET_VARIABLE: str(self.judge_socket)}

    def abandon(self) -> None:
        """Kill the processes, and do not wait for their end; see :meth:`BoxedProcesses.abandon`."""
        for process in list(self._started):
            process.abandon()

    def start_kernel(self, channels: Channels) -> ForkedProcess:
        """Start the kernel as a fork of the fork server."""
        environment = kernel_environment(self.folder, self._variables)
        call = _request("kernel", channels, channels.folder)
        entrance = Entrance(str(self._cwd), environment, boxed=False, call=call)
        return self._start(self._addresses.kernels, entrance, [channels.shell, channels.iopub, channels.log])

    def start_desk(self, channels: Channels) -> ForkedProcess:
        """Start the kernel's desk as another child of the same fork server."""
        entrance = _desk_entrance(channels, channels.folder, self.limits, boxed=False)
        return self._start(self._addresses.kernels, entrance, [channels.orders])

    def start_judge(self, listener: int, orders: int, *, of_programs: bool = False) -> ForkedProcess:
        """Start a judge as a fork of the judges' fork server."""
        del of_programs
        environment = kernel_environment(self.folder / "of-the-judge", self._judges_variables)
        entrance = Entrance(str(self.folder), environment, boxed=False, rlimits=self.limits.of_the_judge)
        return self._start(self._addresses.judges, entrance, [listener, orders])

    def _start(self, server: str, entrance: Entrance, descriptors: Sequence[int]) -> ForkedProcess:
        process = ForkedProcess(server, entrance, descriptors)
        self._started.append(process)
        return process

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass


def _request(name: str, channels: Channels, folder: Path, **words: Any) -> dict[str, Any]:
    """Return what a fork is asked to be. ``folder`` is that of the kernel's sockets, as the fork sees it."""
    return {"request": name, "words": {"address": str(folder / "k"), "key": channels.key, **words}}


def _desk_entrance(channels: Channels, folder: Path, limits: Limits, *, boxed: bool) -> Entrance:
    """Return the settings with which a kernel's desk starts. ``folder`` is that of the sockets, as the desk sees it."""
    return Entrance(
        cwd="/",
        environment=base_environment(),
        boxed=boxed,
        rlimits=limits.of_the_desk,
        call=_request("desk", channels, folder, limits=asdict(limits)),
        reader_seconds=int(limits.cpu_seconds),
        filters_itself=True,
    )


NotebookProcesses = BoxedProcesses | UnboxedProcesses
"""The two kinds of processes of a notebook. The path of ``folder`` must be short, because the name of a Unix socket has
at most 107 characters.
"""
