"""The place where a notebook runs: in boxes, or without them where somebody has asked for that.

A place starts the two processes of a notebook, its kernel and its judge, and leaves nothing behind.
"""

from __future__ import annotations

import contextlib
import itertools
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

from autograder.boxes.boxed_processes import ForkedProcess
from autograder.boxes.entering import Entrance
from autograder.boxes.environment import box_environment, kernel_environment
from autograder.boxes.guards import BoxGuard, NoGuard
from autograder.boxes.mounts import HOME, WORK, Bind
from autograder.boxes.sandbox import Enclosure
from autograder.temporary_folders import write_files

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.boxes.fork_server import Addresses
    from autograder.boxes.kernel import Channels
    from autograder.boxes.limits import Limits

SHARED_FOLDER = Path("/run/judge")
"""The path in the student's box of the folder that it shares with its grader."""
_STUDENT, _JUDGE = "student", "judge"
_PROGRAMS_SCRATCH_BYTES, _PROGRAMS_SCRATCH_FILES = 1_000_000, 1_000
"""Nobody writes there but the supervisor: what a program writes is in memory of its own box."""


@dataclass(frozen=True)
class JudgeSetting:
    """The needs of a judge's process; named by the grader, because boxes know no judge.

    Attributes:
        environment: More variables of its environment.
        readable: Folders that only a judge may see, such as the reference outputs.
    """

    environment: Mapping[str, str] = field(default_factory=dict)
    readable: Sequence[Path] = ()


class BoxedPlace:
    """The boxes of one submission, in one network or in two.

    The student's box and a judge's are on the notebook's network. What the grader itself builds and starts for a check,
    from sources that were handed in, runs on another network, with a judge of its own: nobody in the student's box can
    say anything there, whatever it does.

    Args:
        addresses: The fork servers.
        folder: Ours alone; short, because Unix sockets will be in it.
        files: What is beside the notebook.
        variables: More variables of the kernel's environment.
        socket_variable: The one that tells the kernel where the judge is.
        judge: What the judge's process needs.
        limits: The limits of the kernel and of all that it starts.
        programs: Whether there is to be a network for programs.

    Raises:
        NoSandbox: The namespaces could not be made.
    """

    def __init__(
        self,
        addresses: Addresses,
        folder: Path,
        files: Mapping[str, bytes],
        variables: Mapping[str, str],
        socket_variable: str,
        judge: JudgeSetting,
        limits: Limits,
        *,
        programs: bool = False,
    ) -> None:
        self._addresses, self._judge, self._limits = addresses, judge, limits
        self._open = contextlib.ExitStack()
        self._judges = itertools.count(1)
        self._shared = folder / "run"
        self._shared.mkdir()
        self._variables = {**variables, socket_variable: str(SHARED_FOLDER / _JUDGE)}
        self.guard = BoxGuard(limits)
        self._open.callback(self.guard.close)
        try:
            self.enclosure = self._open.enter_context(
                Enclosure(
                    addresses.supervisors, folder / "box", files=files,
                    scratch_bytes=limits.scratch_bytes, scratch_inodes=limits.scratch_files, guard=self.guard,
                )
            )  # fmt: skip
            self.programs = self.enclosure if not programs else self._open.enter_context(
                Enclosure(
                    addresses.supervisors, folder / "programs",
                    scratch_bytes=_PROGRAMS_SCRATCH_BYTES, scratch_inodes=_PROGRAMS_SCRATCH_FILES, guard=self.guard,
                )
            )  # fmt: skip
        except BaseException:
            self._open.close()
            raise

    @property
    def judge_socket(self) -> Path:
        """The judge's socket; of the judge, the student's box sees the folder of this socket alone."""
        return self._shared / _JUDGE

    @property
    def shared(self) -> Path:
        """The folder that the student's box sees as ``SHARED_FOLDER``, and may only read."""
        return self._shared

    def start_kernel(self, channels: Channels) -> ForkedProcess:
        """Let a fork of the fork server enter the student's box."""
        box = self.enclosure.box(_STUDENT, [Bind(self._shared, SHARED_FOLDER)], guarded=True)
        self.guard.watch(box.pid)
        return self.enclosure.enter(
            box,
            self._addresses.kernels,
            [channels.shell, channels.iopub, channels.log],
            cwd=WORK,
            environment=box_environment(self._variables),
            call={"key": channels.key, "address": channels.address},
        )

    def start_judge(self, listener: int, orders: int, *, of_programs: bool = False) -> ForkedProcess:
        """Let a fork of the judges' fork server enter a box of its own.

        Args:
            listener: Where the notebook will reach it.
            orders: Where the grader will.
            of_programs: On the network of programs instead of the notebook's.
        """
        enclosure = self.programs if of_programs else self.enclosure
        name = f"{_JUDGE} {next(self._judges)}"
        box = enclosure.box(name, [Bind(path) for path in self._judge.readable], scratch=False)
        return enclosure.enter(
            box,
            self._addresses.judges,
            [listener, orders],
            cwd=HOME,
            environment=box_environment(self._judge.environment),
            rlimits=self._limits.of_the_judge,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()


class UnboxedPlace:
    """No box: forks of the fork servers with the rights of whoever grades.

    For the course's own notebooks, and for ``--unsafe-no-sandbox``. Arguments as for :class:`BoxedPlace`.
    """

    def __init__(
        self,
        addresses: Addresses,
        folder: Path,
        files: Mapping[str, bytes],
        variables: Mapping[str, str],
        socket_variable: str,
        judge: JudgeSetting,
        limits: Limits,
        *,
        programs: bool = False,
    ) -> None:
        del programs  # there is one network, the host's
        self._addresses, self._folder, self._judge, self._limits = addresses, folder, judge, limits
        self.guard = NoGuard()
        self._cwd = write_files(files, folder / "work")
        self._variables = {**variables, socket_variable: str(self.judge_socket)}

    @property
    def judge_socket(self) -> Path:
        """The socket on which the judge is to listen."""
        return self._folder / _JUDGE

    def start_kernel(self, channels: Channels) -> ForkedProcess:
        """Let a fork of the fork server be the kernel."""
        entrance = Entrance(
            cwd=str(self._cwd),
            environment=kernel_environment(self._folder, self._variables),
            boxed=False,
            call={"key": channels.key, "address": channels.address},
        )
        descriptors = [channels.shell, channels.iopub, channels.log]
        return ForkedProcess(self._addresses.kernels, entrance, descriptors)

    def start_judge(self, listener: int, orders: int, *, of_programs: bool = False) -> ForkedProcess:
        """Let a fork of the judges' fork server be the judge."""
        del of_programs
        environment = kernel_environment(self._folder / "of-the-judge", self._judge.environment)
        entrance = Entrance(
            cwd=str(self._folder), environment=environment, boxed=False, rlimits=self._limits.of_the_judge
        )
        return ForkedProcess(self._addresses.judges, entrance, [listener, orders])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass
