"""Boxes of one submission: made, entered, used for a command, ended.

.. code-block:: python

    with Enclosure(addresses.supervisors, folder, files={"data.csv": b"1,2"}) as enclosure:
        box = enclosure.box("student", [Bind(folder_of_the_socket, Path("/run/judge"))])
        done = enclosure.run(["ros2", "run", "my_robot_pkg", "talker"], limit=30.0)

All boxes of an enclosure share one network namespace with nothing in it but the loopback interface: their ROS
nodes meet each other and nobody else, whatever the domain. When the enclosure is closed, or its process is killed,
no process of any of its boxes is left and its scratch is gone.
"""

from __future__ import annotations

import functools
import itertools
import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from autograder.boxes.box import Box, NoSandbox, Supervision
from autograder.boxes.boxed_processes import Finished, ForkedProcess, Running, WarmCommand
from autograder.boxes.channel import close_all
from autograder.boxes.entering import Entrance
from autograder.boxes.environment import box_environment
from autograder.boxes.fork_server import BESIDE, SUPERVISOR_MODULE, ForkServer, library_folders
from autograder.boxes.mounts import HOME, WORK, Bind, Link, box_arguments
from autograder.temporary_folders import HeldFolder, write_files

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.boxes.guards import BoxGuard

__all__ = ["Bind", "Box", "Enclosure", "Finished", "NoSandbox", "why_impossible"]

SCRATCH_BYTES = 1_000_000_000
SCRATCH_INODES = 200_000
OUTPUT_BYTES = 1_000_000


class Enclosure:
    """The network, the scratch and the boxes of one submission. Threads take turns.

    Args:
        supervisors: Where the fork server of supervisors listens.
        folder: Ours alone and short-lived; nothing of it is seen in a box but what is bound. Made where it is not.
        files: Files to be in the notebook's folder, by relative path.
        scratch_bytes: What all files that the boxes write may have together.
        scratch_inodes: How many files, folders and links there may be.
        guard: Holds the limits of the commands; they share them with whatever else it guards.

    Raises:
        NoSandbox: The supervisor could not make the namespaces.
    """

    def __init__(
        self,
        supervisors: str,
        folder: Path,
        *,
        files: Mapping[str, bytes] | None = None,
        scratch_bytes: int = SCRATCH_BYTES,
        scratch_inodes: int = SCRATCH_INODES,
        guard: BoxGuard | None = None,
    ) -> None:
        self._scratch = folder / "scratch"
        self._scratch.mkdir(parents=True)
        self._guard = guard
        self._commands = itertools.count(1)
        self._supervision = Supervision(
            supervisors,
            scratch=str(self._scratch),
            size=scratch_bytes,
            inodes=scratch_inodes,
            files=str(write_files(files, folder / "files")) if files else "",
        )

    def box(
        self, name: str, binds: Sequence[Bind | Link] = (), *, scratch: bool = True, guarded: bool = False
    ) -> Box:
        """Make an empty box, for a fork server's child to enter.

        Args:
            name: Not yet used in this enclosure.
            binds: What it is to see beside the system, Python and the course's package.
            scratch: Give it the enclosure's scratch; else it has a small one of its own.
            guarded: What enters it has the limits of the guard, and so have its first processes: who is in a box can
                make them do anything.

        Raises:
            NoSandbox: It could not be made.
        """
        return self._supervision.start(
            name,
            guarded=guarded,
            arguments=box_arguments(self._scratch, binds, scratch_visible=scratch),
            command=[],
            **(self._guarded() if guarded else {}),
        )

    def enter(
        self,
        box: Box,
        server: str,
        descriptors: Sequence[int],
        *,
        cwd: Path,
        environment: Mapping[str, str],
        call: Mapping[str, Any] | None = None,
        rlimits: Mapping[str, int] | None = None,
    ) -> ForkedProcess:
        """Let a fork of a fork server enter a box.

        Args:
            box: One of this enclosure.
            server: Where that fork server listens.
            descriptors: What the process is given; they stay open here.
            cwd: Its folder.
            environment: Its whole environment.
            call: What it is told.
            rlimits: Its limits in a box without a guard (setrlimit(2)).

        Raises:
            ChannelClosed: The fork server is gone, or the fork could not enter the box.
        """
        entrance = Entrance(
            cwd=str(cwd),
            environment=environment,
            boxed=True,
            call=call or {},
            **(self._guarded() if box.guarded else {"rlimits": rlimits or {}}),
        )
        return ForkedProcess(server, entrance, descriptors, box)

    def run(
        self,
        command: Sequence[str],
        *,
        limit: float,
        binds: Sequence[Bind] = (),
        cwd: Path = WORK,
        output_bytes: int = OUTPUT_BYTES,
    ) -> Finished:
        """Run a command with the scratch in a box of its own until it ends; the rest is as for :meth:`start`.

        When this returns no process of that box is alive, daemons included.

        Args:
            command: See :meth:`start`.
            limit: Seconds of wall time; then the whole box is killed.
            binds: See :meth:`start`.
            cwd: Where it starts.
            output_bytes: How much of its output is kept.

        Raises:
            NoSandbox: The box could not be made.
        """
        with self.start(command, binds=binds, cwd=cwd, output_bytes=output_bytes) as running:
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
    ) -> Running:
        """Start a command in a box of its own, in the submission's network namespace.

        Leaving the context of what comes back ends it and all that it has started.

        Args:
            command: Program and arguments, as they are called in the box.
            binds: What the box is to see beside the system, Python and the course's package.
            environment: Its whole environment; :func:`autograder.boxes.environment.box_environment` where None.
            cwd: Where it starts.
            output_bytes: How much of its output is kept.
            scratch: See :meth:`box`. Two commands with the scratch see each other's files.

        Raises:
            NoSandbox: The box could not be made.
        """
        words = box_arguments(self._scratch, binds, scratch_visible=scratch)
        for variable, value in (box_environment() if environment is None else environment).items():
            words += ["--setenv", variable, value]
        reading, writing = os.pipe()
        nothing = os.open(os.devnull, os.O_RDONLY)
        try:
            box = self._supervision.start(
                self._next_name(),
                [nothing, writing, writing],
                arguments=[*words, "--chdir", str(cwd)],
                command=list(command),
                **self._guarded(),
            )
        except BaseException:
            os.close(reading)
            raise
        finally:
            close_all([nothing, writing])
        return Running(box, reading, output_bytes)

    def ros2(
        self,
        programs: str,
        words: Sequence[str],
        *,
        binds: Sequence[Bind],
        environment: Mapping[str, str],
        cwd: Path = WORK,
    ) -> WarmCommand:
        """Start `ros2` with these words in a box of its own without the scratch, from the fork server of programs.

        Args:
            programs: Where that fork server listens.
            words: Beginning with ``run``.
            binds: See :meth:`start`.
            environment: Its whole environment.
            cwd: Where it starts.
        """
        libraries = _own_libraries(environment)
        links = [Link(*pair) for pair in zip(library_folders(programs), libraries, strict=False)]
        box = self.box(self._next_name(), [*binds, *links], scratch=False, guarded=True)
        reading, writing = os.pipe()
        try:
            process = self.enter(
                box,
                programs,
                [writing],
                cwd=cwd,
                environment={**environment, "PWD": str(cwd)},
                call={"words": list(words)},
            )
        except BaseException:
            os.close(reading)
            box.end()
            raise
        finally:
            os.close(writing)
        return WarmCommand(process, reading, box.pid)

    def close(self) -> None:
        """End all boxes and wait until none of their processes is alive; may be called twice."""
        self._supervision.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

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


def _own_libraries(environment: Mapping[str, str]) -> list[Path]:
    """The folders of libraries that an environment has beside those of every box."""
    of_every_box = box_environment().get("LD_LIBRARY_PATH", "").split(os.pathsep)
    folders = environment.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    return [Path(folder) for folder in folders if folder not in of_every_box]


@functools.cache
def why_impossible() -> str:
    """The reason why no sandbox is possible here and what to do, in one sentence; empty where one is.

    Found out by making one.
    """
    if shutil.which("bwrap") is None:
        return "bubblewrap is not installed. On Debian or Ubuntu, type: sudo apt-get install -y bubblewrap"
    with HeldFolder("autograder-try-") as held:
        folder = held.path
        supervisors = ForkServer(BESIDE, SUPERVISOR_MODULE, folder / "supervisors")
        try:
            with Enclosure(supervisors.address, folder / "try") as enclosure:
                done = enclosure.run(["/bin/sh", "-c", f"test -d {HOME}"], limit=20.0)
            return (
                ""
                if done.returncode == 0
                else f"a program in a box ended with {done.output.decode()[-300:]!r}"
            )
        except (NoSandbox, OSError) as error:
            return f"{_reason(str(error))} ({error})"
        finally:
            supervisors.stop()


def _reason(error: str) -> str:
    """The usual meaning of a refusal."""
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


if __name__ == "__main__":  # asked by the doctor, as this process may not be the course's own Python
    from autograder.boxes.guards import guards

    print(json.dumps({"why_impossible": why_impossible(), "guards": dict(guards())}))
