"""Where a notebook runs: in boxes, or, where that was asked for in as many words, beside them.

A place starts the two processes of a notebook, its kernel and its judge, and leaves nothing behind.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

from autograder.boxes.entering import Entrance
from autograder.boxes.environment import box_environment, kernel_environment
from autograder.boxes.forked import ForkedProcess
from autograder.boxes.guards import BoxGuard, NoGuard
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.scratch import write_files
from autograder.boxes.view import HOME, WORK, Bind

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

    from autograder.boxes.forkserver import Addresses
    from autograder.boxes.kernel import Channels
    from autograder.boxes.limits import Limits

DOOR = Path("/run/judge")
"""Where the student's box sees the folder that it shares with its grader."""
_STUDENT, _JUDGE = "student", "judge"


@dataclass(frozen=True)
class JudgeSetting:
    """What a judge's process needs; named by the grader, because boxes know no judge.

    Attributes:
        environment: More variables of its environment.
        readable: Folders that only a judge may see, such as the reference outputs.
    """

    environment: Mapping[str, str] = field(default_factory=dict)
    readable: Sequence[Path] = ()


class BoxedPlace:
    """Two boxes in one network namespace.

    Args:
        addresses: The warm processes.
        folder: Ours alone; short, because Unix sockets will be in it.
        files: What lies beside the notebook.
        variables: More variables of the kernel's environment.
        socket_variable: The one that tells the kernel where the judge is.
        judge: What the judge's process needs.
        limits: The limits of the kernel and of all that it starts.

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
    ) -> None:
        self._addresses, self._judge, self._limits = addresses, judge, limits
        self._door = folder / "door"
        self._door.mkdir()
        self._variables = {**variables, socket_variable: str(DOOR / _JUDGE)}
        self._student: list[int] = []
        self.guard = BoxGuard(limits)
        try:
            self.enclosure = Enclosure(
                addresses.keepers, folder / "box", files=files,
                scratch_bytes=limits.scratch_bytes, scratch_inodes=limits.scratch_files, guard=self.guard,
            )  # fmt: skip
        except BaseException:
            self.guard.close()
            raise

    @property
    def judge_socket(self) -> Path:
        """Where the judge is to listen; the student's box sees the folder of this socket and nothing else of it."""
        return self._door / _JUDGE

    @property
    def shared(self) -> Path:
        """The folder that the student's box sees as ``DOOR``, and may only read."""
        return self._door

    def students_processes(self) -> list[int]:
        """The uppermost processes of the student's box, as the host counts: all others are below them."""
        return list(self._student)

    def start_kernel(self, channels: Channels) -> PlacedProcess:
        """Let a fork of the warm process enter the student's box."""
        box = self.enclosure.box(_STUDENT, [Bind(self._door, DOOR)])
        self.guard.watch(box.pid)
        entrance = Entrance(
            cwd=str(WORK),
            environment=box_environment(self._variables),
            boxed=True,
            cgroups=self.guard.cgroups,
            rlimits=self.guard.rlimits,
            hidden_memory=self.guard.hidden_memory,
            call={"key": channels.key, "address": channels.address},
        )
        process = ForkedProcess(
            self._addresses.kernels, entrance, [box.pidfd, channels.shell, channels.iopub, channels.log]
        )
        # Whoever loses its parent in the box gets the box's first process for one.
        self._student = [box.pid, process.pid]
        return PlacedProcess(process, lambda: self.enclosure.end(_STUDENT))

    def start_judge(self, listener: int, orders: int) -> PlacedProcess:
        """Let a fork of the judges' warm process enter a box of its own."""
        box = self.enclosure.box(_JUDGE, [Bind(path) for path in self._judge.readable], scratch=False)
        entrance = Entrance(
            cwd=str(HOME),
            environment=box_environment(self._judge.environment),
            boxed=True,
        )
        return PlacedProcess(
            ForkedProcess(self._addresses.judges, entrance, [box.pidfd, listener, orders]),
            lambda: self.enclosure.end(_JUDGE),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.enclosure.close()
        finally:
            self.guard.close()


class UnboxedPlace:
    """No box: forks of the warm processes with the rights of whoever grades.

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
    ) -> None:
        self._addresses, self._folder, self._judge, self._limits = addresses, folder, judge, limits
        self.guard = NoGuard()
        self._cwd = write_files(files, folder / "work")
        self._variables = {**variables, socket_variable: str(self.judge_socket)}

    @property
    def judge_socket(self) -> Path:
        """Where the judge is to listen."""
        return self._folder / _JUDGE

    def start_kernel(self, channels: Channels) -> PlacedProcess:
        """Let a fork of the warm process be the kernel."""
        entrance = Entrance(
            cwd=str(self._cwd),
            environment=kernel_environment(self._folder, self._variables),
            boxed=False,
            call={"key": channels.key, "address": channels.address},
        )
        process = ForkedProcess(
            self._addresses.kernels, entrance, [channels.shell, channels.iopub, channels.log]
        )
        return PlacedProcess(process, process.kill)

    def start_judge(self, listener: int, orders: int) -> PlacedProcess:
        """Let a fork of the judges' warm process be the judge."""
        environment = kernel_environment(self._folder / "of-the-judge", self._judge.environment)
        entrance = Entrance(cwd=str(self._folder), environment=environment, boxed=False)
        process = ForkedProcess(self._addresses.judges, entrance, [listener, orders])
        return PlacedProcess(process, process.kill)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pass


class PlacedProcess:
    """A process in its place; ends with all that it has started.

    Args:
        process: The process.
        end: Ends it and all that it has started.
    """

    def __init__(self, process: ForkedProcess, end: Callable[[], object]) -> None:
        self._process, self._end = process, end

    def fileno(self) -> int:
        """Readable when the process has ended."""
        return self._process.fileno()

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._process.alive

    @property
    def lost(self) -> bool:
        """Whether nobody can tell any more what became of it."""
        return self._process.lost

    def interrupt(self) -> None:
        """SIGINT to its process group."""
        self._process.interrupt()

    def wait(self, within: float) -> bool:
        """Wait so many seconds for its end; whether it came."""
        return self._process.wait(within)

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        with contextlib.suppress(OSError):
            self._end()
        self._process.close()
