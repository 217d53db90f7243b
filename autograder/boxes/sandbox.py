"""The boxes of one submission, or of one command that a user runs by hand.

.. code-block:: python

    with Enclosure(addresses.supervisors, folder, files={"data.csv": b"1,2"}) as enclosure:
        box = enclosure.box("student", [Bind(folder_of_the_socket, Path("/run/judge"))])
        done = enclosure.run(["ros2", "run", "my_robot_pkg", "talker"], limit=30.0)

All boxes of an enclosure share one network namespace, which has only the loopback interface. So their ROS nodes can
reach each other but no other node, whatever the domain. When the enclosure is closed, or its process is killed, all
processes in its boxes end and the scratch is removed.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import json
import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.boxes.box_connection import Box, NoSandbox, Supervision, close_all
from autograder.boxes.box_supervisor import bubblewrap, furnish
from autograder.boxes.boxed_processes import Finished, ForkedProcess, Running, WarmCommand
from autograder.boxes.cgroups import guards
from autograder.boxes.fork_server import BESIDE, SUPERVISOR_MODULE, ForkServer, library_folders
from autograder.boxes.limit_guards import BoxGuard
from autograder.boxes.process_isolation import Entrance, leave_the_host, take_limits
from autograder.boxes.run_limits import Limits
from autograder.boxes.visible_host import (
    HOME,
    SYSTEM,
    WORK,
    Bind,
    SymbolicLink,
    box_arguments,
    box_environment,
    installation,
)
from autograder.safe_files import HeldFolder, write_files
from autograder.standard_output import collect

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


_SCRATCH_BYTES = 1_000_000_000
_SCRATCH_INODES = 200_000
_OUTPUT_BYTES = 1_000_000


class Enclosure(Supervision):
    """The network, the scratch (a file system in memory) and the boxes of one submission.

    Several threads may use an enclosure.

    Args:
        supervisors: The socket address of the fork server that starts supervisors.
        folder: A temporary folder that nothing else uses; it is created if it does not exist.
        files: Files to put into the notebook's folder, by relative path.
        scratch_bytes: The maximum size in bytes of all files that the boxes write into the scratch together.
        scratch_inodes: The maximum number of files, folders and links in the scratch.
        guard: Enforces the limits on this enclosure's commands, together with the other boxes that have this guard.

    Raises:
        NoSandbox: The supervisor could not make the namespaces.
    """

    def __init__(
        self,
        supervisors: str,
        folder: Path,
        *,
        files: Mapping[str, bytes] | None = None,
        scratch_bytes: int = _SCRATCH_BYTES,
        scratch_inodes: int = _SCRATCH_INODES,
        guard: BoxGuard | None = None,
    ) -> None:
        self._scratch = folder / "scratch"
        self._scratch.mkdir(parents=True)
        self._guard = guard
        self._commands = itertools.count(1)
        super().__init__(
            supervisors,
            scratch=str(self._scratch),
            size=scratch_bytes,
            inodes=scratch_inodes,
            files=str(write_files(files, folder / "files")) if files else "",
        )

    def box(
        self,
        name: str,
        binds: Sequence[Bind | SymbolicLink] = (),
        *,
        scratch: bool = True,
        guarded: bool = False,
    ) -> Box:
        """Make an empty box, which a child of a fork server can enter.

        Args:
            name: A name that no other box of this enclosure has.
            binds: The files that the box sees in addition to the system, Python and this package.
            scratch: True if the box gets the enclosure's scratch; False if it gets a small scratch of its own.
            guarded: True if the guard's limits apply to every process that enters the box, and to the box's own first
                processes, which a program inside could control.

        Raises:
            NoSandbox: The box could not be made.
        """
        return self._start(
            name,
            guarded=guarded,
            arguments=box_arguments(self._scratch, binds, scratch_visible=scratch),
            command=[],
            **(self._guarded() if guarded else {}),
        )

    def enter(self, box: Box, server: str, descriptors: Sequence[int], entrance: Entrance) -> ForkedProcess:
        """Let a fork server fork a process that enters a box, and return the process.

        Args:
            box: A box of this enclosure.
            server: The socket address of the fork server.
            descriptors: File descriptors for the process. The caller keeps its own copies.
            entrance: The settings of the process. In a guarded box, the limits of the guard replace the limits in them.

        Raises:
            ChannelClosed: The fork server has ended, or its child could not enter the box.
        """
        if box.guarded:
            entrance = replace(entrance, **self._guarded())
        return ForkedProcess(server, entrance, descriptors, box)

    def run(
        self, command: Sequence[str], *, limit: float, output_bytes: int = _OUTPUT_BYTES, **settings: Any
    ) -> Finished:
        """Run a command in a new box, and wait for the command to end. When this returns, the whole box has ended.

        The box is killed after ``limit`` seconds of wall time. Of the output, ``output_bytes`` bytes are kept. The
        other arguments are those of :meth:`start`.

        Raises:
            NoSandbox: The box could not be made.
        """
        with self.start(command, **settings) as running:
            said = collect(running, limit, output_bytes)
            return Finished(running.exit_code() if said.ended else None, said.output, said.cut)

    def start(
        self,
        command: Sequence[str],
        *,
        binds: Sequence[Bind] = (),
        environment: Mapping[str, str] | None = None,
        cwd: Path = WORK,
        scratch: bool = True,
    ) -> Running:
        """Start a command in a new box, in the submission's network namespace.

        The returned object is a context manager. At the end of its ``with`` block, the command and everything that it
        started are ended.

        Args:
            command: The program and its arguments, with paths as seen in the box.
            binds: As for :meth:`box`.
            environment: All environment variables; None for those of
                :func:`autograder.boxes.visible_host.box_environment`.
            scratch: As for :meth:`box`. In the enclosure's scratch, commands see each other's files.

        Raises:
            NoSandbox: The box could not be made.
        """
        words = box_arguments(self._scratch, binds, scratch_visible=scratch)
        for variable, value in (box_environment() if environment is None else environment).items():
            words += ["--setenv", variable, value]
        reading, writing = os.pipe()
        nothing = os.open(os.devnull, os.O_RDONLY)
        try:
            box = self._start(
                self._next_name(),
                [nothing, writing, writing],
                arguments=[*words, "--chdir", str(cwd)],
                command=list(command),
                **self._guarded(),
            )
        except BaseException:
            os.close(reading)
            raise
        # The box has its own copies. While this one is open, reading would not end with the command.
        finally:
            close_all([nothing, writing])
        return Running(box, reading)

    def ros2(
        self,
        programs: str,
        words: Sequence[str],
        *,
        binds: Sequence[Bind],
        environment: Mapping[str, str],
        cwd: Path = WORK,
    ) -> WarmCommand:
        """Start a `ros2` command in a new box, as a child of the fork server for programs.

        The box does not see the enclosure's scratch.

        Args:
            programs: The socket address of the fork server for programs.
            words: The arguments of `ros2`, such as ``["run", "my_package", "talker"]``.
            binds: As for :meth:`box`.
            environment: All environment variables.
        """
        of_every_box = box_environment().get("LD_LIBRARY_PATH", "").split(os.pathsep)
        libraries = environment.get("LD_LIBRARY_PATH", "").split(os.pathsep)
        own_libraries = [Path(folder) for folder in libraries if folder not in of_every_box]
        # The program's process has already read where to look for libraries, so this box links the build's folders to
        # the places in that fixed list.
        links = [SymbolicLink(*pair) for pair in zip(library_folders(programs), own_libraries, strict=False)]
        box = self.box(self._next_name(), [*binds, *links], scratch=False, guarded=True)
        reading, writing = os.pipe()
        try:
            variables = {**environment, "PWD": str(cwd)}
            entrance = Entrance(str(cwd), variables, boxed=True, call={"words": list(words)})
            process = self.enter(box, programs, [writing], entrance)
        except BaseException:
            os.close(reading)
            box.end()
            raise
        finally:
            os.close(writing)
        return WarmCommand(process, reading, box.pid)

    def _next_name(self) -> str:
        return f"command {next(self._commands)}"

    def _guarded(self) -> dict[str, Any]:
        if self._guard is None:
            return {}
        return {
            "cgroups": self._guard.cgroups,
            "rlimits": self._guard.rlimits,
            "hidden_memory": self._guard.hidden_memory,
        }


@contextlib.contextmanager
def lone_enclosure(folder: Path) -> Iterator[Enclosure]:
    """Make an enclosure with a fork server of its own, in an existing folder that nothing else uses.

    Raises:
        NoSandbox: The supervisor could not make the namespaces.
    """
    supervisors = ForkServer(BESIDE, SUPERVISOR_MODULE, folder / "supervisors")
    try:
        with Enclosure(supervisors.address, folder / "box") as enclosure:
            yield enclosure
    finally:
        supervisors.stop()


class OneCommandBox:
    """Gives this process a new network, and each start of a command a separate box in that network.

    Args:
        scratch: An empty folder. Only this process and the boxes see the files that are made in it.
        folder: The folder of the user that a command sees, read-only and at the same path. It is also the working
            folder.
        command: The command, which is checked for names of files that would not be visible.
        more: Further folders that a command sees, read-only and at the same path.
        variables: Further environment variables of a command.

    Raises:
        ValueError: The folder contains files that no box may see, or the command needs files outside the folder. The
            exception's text says what to do.
    """

    def __init__(
        self,
        scratch: Path,
        folder: Path,
        command: Sequence[str],
        more: Sequence[Path] = (),
        variables: Mapping[str, str] | None = None,
    ) -> None:
        self._scratch, self._folder = scratch, folder.resolve()
        self._more, self._variables = more, variables or {}
        visible = (self._folder, *map(Path, SYSTEM), *installation())
        for word in command:
            file = self._folder / word
            is_visible = any(map(Path(os.path.normpath(file)).is_relative_to, visible))
            if os.sep in word and file.exists() and not is_visible:
                raise ValueError(
                    f"a command in a box sees only the folder in which it starts, and {word} is not in "
                    f"{self._folder}: change to the folder of the submission, and use a path relative to it"
                )
        for kept in (Path.home(), Path(__file__).resolve().parents[2]):
            if kept.resolve().is_relative_to(self._folder):
                raise ValueError(
                    f"a command in a box sees the folder in which it starts, and {self._folder} contains files that it "
                    "must not see: change to the folder of the submission"
                )
        self._guard = BoxGuard(Limits())

    def enter(self) -> None:
        """Leave the host's network for one that has only a loopback interface. The process must have no other threads.

        Raises:
            OSError: The system does not allow such namespaces.
        """
        leave_the_host()
        furnish(self._scratch, _SCRATCH_BYTES, _SCRATCH_INODES)

    def start_of(self, command: Sequence[str], environment: Mapping[str, str]) -> tuple[list[str], list[int]]:
        """Return the command line that starts a command in a box, and its descriptors, which the caller has to close.

        Args:
            environment: The command's environment outside a box. Variables that Python and ROS need are kept.
        """
        words = box_arguments(self._scratch, list(map(Bind, (self._folder, *self._more))))
        settings = ("PYTHONUNBUFFERED", "PYTHONFAULTHANDLER")
        extra = {name: environment[name] for name in settings if name in environment}
        for name, value in box_environment({**extra, **self._variables}, environment).items():
            words += ["--setenv", name, value]
        words += ["--chdir", str(self._folder)]
        begin, descriptors = bubblewrap(words, hidden_memory=self._guard.hidden_memory)
        return [*begin, *command], descriptors

    def limit(self) -> None:
        """Apply the limits of the box. Call this in the child, before the command is executed."""
        take_limits(self._guard.cgroups, self._guard.rlimits)

    def close(self) -> None:
        """Remove the cgroups. Call this after every command has ended."""
        self._guard.close()


@functools.cache
def why_impossible() -> str:
    """Return one sentence that says why no sandbox is possible here and what to do; empty if one is possible.

    To find out, the function tries to make one.
    """
    if shutil.which("bwrap") is None:
        return "bubblewrap is not installed. On Debian or Ubuntu, type: sudo apt-get install -y bubblewrap"
    with HeldFolder("autograder-try-") as held:
        try:
            with lone_enclosure(held.path) as enclosure:
                done = enclosure.run(["/bin/sh", "-c", f"test -d {HOME}"], limit=20.0)
            if done.returncode == 0:
                return ""
            return f"a program in a box ended with {done.output.decode()[-300:]!r}"
        except (NoSandbox, OSError) as error:
            return f"{_reason(str(error))} ({error})"


def _reason(error: str) -> str:
    """Return what an error of bubblewrap usually means."""
    apparmor = Path("/proc/sys/kernel/apparmor_restrict_unprivileged_userns")
    if os.geteuid() != 0 and apparmor.exists() and apparmor.read_text().strip() == "1":
        return (
            "this system does not let ordinary users make user namespaces: type sudo sysctl "
            "kernel.apparmor_restrict_unprivileged_userns=0, or grade as root"
        )
    if "unshare" in error or "namespace" in error:
        return (
            "this system or its container allows no user namespaces: set the sysctls user.max_user_namespaces and, "
            "if it exists, kernel.unprivileged_userns_clone, or start the container with "
            "--security-opt seccomp=unconfined"
        )
    return "no box could be made here"


if __name__ == "__main__":
    # doctor runs this file as a program, because doctor may run outside the course's Python
    print(json.dumps({"why_impossible": why_impossible(), "guards": dict(guards())}))
