"""Starting and asking the fork servers: one each for supervisors, kernels, judges, and students' programs."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from autograder.boxes.environment import base_environment
from autograder.boxes.fork_server import BESIDE, FOLDER_PREFIX, INSIDE, library_folders
from autograder.boxes.held_folder import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
SUPERVISOR_MODULE = "autograder.boxes.supervisor"
KERNEL_MODULE = "autograder.boxes.kernel_process"
PROGRAM_MODULE = "autograder.boxes.program_process"
_GOODBYE_SECONDS = 3.0


class ForkServer:
    """A fork server that was started here; it ends with this object or with this process.

    Args:
        mode: ``BESIDE`` or ``INSIDE``, see :mod:`autograder.boxes.fork_server`.
        module: What it serves.
        address: The path of the socket to be made. No box may see it.
        log: Takes what it says on standard error; dropped where there is none.
        extra: More variables of its environment, and so of the environment in which modules are imported.
        words: What the module's ``prepare`` is told. Its children can read these words, and its environment, too.
    """

    def __init__(
        self,
        mode: str,
        module: str,
        address: Path,
        log: int | None = None,
        extra: Mapping[str, str] | None = None,
        words: Sequence[str] = (),
    ) -> None:
        self.address = str(address)
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
            listener.bind(self.address)
            # From here on one can connect: whoever comes while the process warms up is served when it is warm.
            listener.listen(128)
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-P",
                    "-m",
                    "autograder.boxes.fork_server",
                    mode,
                    module,
                    str(listener.fileno()),
                    *words,
                ],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL if log is None else log,
                env={
                    **base_environment(),
                    "PYDEVD_DISABLE_FILE_VALIDATION": "1",
                    **(extra or {}),
                },
                cwd="/",
                pass_fds=(listener.fileno(),),
                # Ctrl-C goes to the grader, which then ends its boxes in good order.
                start_new_session=True,
            )

    @property
    def alive(self) -> bool:
        """True if it still runs."""
        return self._process.poll() is None

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    def stop(self) -> None:
        """End it and all that it has forked; may be called twice."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        try:
            self._process.wait(_GOODBYE_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        with contextlib.suppress(OSError):
            os.unlink(self.address)  # noqa: PTH108


@dataclass(frozen=True)
class Addresses:
    """The addresses of the fork servers; travels to a worker on its command line.

    Attributes:
        supervisors: For :class:`autograder.boxes.sandbox.Enclosure`. Empty where there is no sandbox.
        kernels: For :class:`autograder.boxes.kernel.Kernel`.
        judges: For the judge.
        programs: For :meth:`autograder.boxes.sandbox.Enclosure.ros2`. Empty where there is no sandbox.
    """

    supervisors: str
    kernels: str
    judges: str
    programs: str = ""


class ForkServers:
    """The fork servers of a batch, started together.

    Args:
        judge_module: What the judges' process serves; it is named here because boxes know no judge.
        boxed: Start those for supervisors and for programs, too.
        log: Takes what they say on standard error.
        environment: More variables for the processes of all but supervisors. Libraries read some when they are loaded.
        of_judges: More variables for the processes of judges alone, such as where the course is.
        interfaces: The modules with the course's interfaces, which a kernel finds imported. It is told no more of the
            course.
    """

    def __init__(
        self,
        judge_module: str,
        *,
        boxed: bool,
        log: int | None = None,
        environment: Mapping[str, str] | None = None,
        of_judges: Mapping[str, str] | None = None,
        interfaces: Sequence[str] = (),
    ) -> None:
        self._folder = HeldFolder(FOLDER_PREFIX)
        place = self._folder.path
        of_judges = {**(environment or {}), **(of_judges or {})}
        self._kernels = ForkServer(INSIDE, KERNEL_MODULE, place / "kernels", log, environment, interfaces)
        self._judges = ForkServer(INSIDE, judge_module, place / "judges", log, of_judges)
        self._supervisors = self._programs = None
        if boxed:
            self._supervisors = ForkServer(BESIDE, SUPERVISOR_MODULE, place / "supervisors", log)
            self._programs = _of_programs(place / "programs", log, environment)
        self.addresses = Addresses(
            self._supervisors.address if self._supervisors else "",
            self._kernels.address,
            self._judges.address,
            self._programs.address if self._programs else "",
        )

    @property
    def alive(self) -> bool:
        """True if all of them still run."""
        return all(process.alive for process in self._all())

    def stop(self) -> None:
        """End them with all boxes, kernels and judges that came from them; may be called twice."""
        for process in self._all():
            process.stop()
        self._folder.remove()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _all(self) -> list[ForkServer]:
        every = (self._supervisors, self._kernels, self._judges, self._programs)
        return [server for server in every if server is not None]


def _of_programs(address: Path, log: int | None, environment: Mapping[str, str] | None) -> ForkServer:
    """Start the fork server of programs, with folders for the libraries of a workspace."""
    folders = library_folders(str(address))
    for folder in folders:
        folder.mkdir()
    given = {**base_environment(), **(environment or {})}.get("LD_LIBRARY_PATH", "")
    path = os.pathsep.join([*map(str, folders), *([given] if given else [])])
    return ForkServer(
        INSIDE,
        PROGRAM_MODULE,
        address,
        log,
        {**(environment or {}), "LD_LIBRARY_PATH": path},
        [given, *map(str, folders)],
    )
