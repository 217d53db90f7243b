"""Runs jobs in boxes: builds without a network, and programs on a network that they share only with a judge."""

from __future__ import annotations

import contextlib
import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.boxes.limit_guards import BoxGuard
from autograder.boxes.run_limits import BUILD_LIMITS, Ended, Limits
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.visible_host import HOME, WORK, Bind, box_environment
from autograder.safe_files import fresh_folder
from autograder.standard_output import collect
from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.jobs import BUILD_SECONDS, MAX_ARCHIVE_BYTES, MAX_LOG_BYTES, BuildOutcome
from autograder.workspaces.program_plans import ros2
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from autograder.boxes.boxed_processes import Running, WarmCommand
    from autograder.workspaces.builds.build_cache import CachedBuild
    from autograder.workspaces.jobs import BuildJob, ProgramJob


PROGRAM_LIMITS = Limits(cpu_seconds=200.0, memory_bytes=1_500_000_000, processes=400)
"""The limits for the box of one program. They apply in addition to the limits of the whole submission."""
PACK_SECONDS = 60.0
"""Time limit in seconds of wall time for packing the result of a build."""


class BoxedJobs:
    """Runs jobs in boxes; implements :class:`autograder.workspaces.jobs.Jobs`.

    Args:
        supervisors: The socket address of the fork server that starts the boxes' supervisors.
        network: The enclosure in which programs run. Its methods are called in the thread of a check.
        folder: A folder for intermediate files that nothing else uses.
        programs: The socket address of the fork server for programs; empty to start each program without a fork
            server.
    """

    def __init__(self, supervisors: str, network: Enclosure, folder: Path, programs: str = "") -> None:
        self._supervisors = supervisors
        self._network = network
        self._folder = folder
        self._programs = programs

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment variables of every box."""
        return box_environment()

    def place(self, name: str, entry: Path) -> Path:
        """Return the path of a build's folder inside a box. The path is below the home folder."""
        del entry
        return HOME / name

    def tree(self, sources: Path) -> Path:
        """Return the path at which a box sees the notebook's folder."""
        del sources
        return WORK

    def build(self, job: BuildJob, command: Sequence[str], entry: CachedBuild) -> BuildOutcome:
        """Run a build in a separate box, and pack its install folder when no process of the build is alive any more.

        The memory limit is low at first, because other builds may run at the same time. If a build reaches this limit,
        it is run again with a higher limit; only one build at a time may do so.
        """
        built, needs_room = self._build(job, command, entry.folder, BUILD_LIMITS)
        if needs_room:
            with self._turn(job.cancelled):
                built, _ = self._build(job, command, entry.folder, replace(BUILD_LIMITS, beside=False))
        return built

    @contextlib.contextmanager
    def _turn(self, cancelled: Callable[[], bool]) -> Iterator[None]:
        """Hold the lock that lets only one build at a time be run again with more memory.

        The lock is on the folder of the fork servers, because all submissions that run at once share this folder.

        Raises:
            GivenUp: The build is no longer needed.
        """
        folder = os.open(Path(self._supervisors).parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            build_cache.await_turn(folder, cancelled)
            yield
        finally:
            os.close(folder)

    def _build(
        self, job: BuildJob, command: Sequence[str], entry: Path, limits: Limits
    ) -> tuple[BuildOutcome, bool]:
        """Return the result of a build, and whether it reached the memory limit."""
        place = self.place(job.name, entry)
        folder = fresh_folder("build-", self._folder)
        binds = [Bind(entry / "src", place / "src"), *_covers(job.hidden, folder)]
        environment = box_environment(job.variables)
        guard = BoxGuard(limits)
        try:
            with Enclosure(
                self._supervisors, folder, guard=guard,
                scratch_bytes=limits.scratch_bytes, scratch_inodes=limits.scratch_files,
            ) as enclosure:  # fmt: skip
                with enclosure.start(command, binds=binds, environment=environment, cwd=HOME) as running:
                    guard.watch(running.pid)
                    said = collect(
                        running,
                        BUILD_SECONDS,
                        MAX_LOG_BYTES,
                        lambda: job.cancelled() or bool(guard.exceeded()),
                    )
                    returncode, output = running.exit_code() if said.ended else None, said.output
                if returncode != 0:
                    needs_room = limits.beside and guard.reason() is Ended.OUT_OF_MEMORY
                    return BuildOutcome(
                        returncode, output, late=BUILD_SECONDS if said.late else 0.0
                    ), needs_room
                packed = enclosure.run(
                    python_child("-m", build_artifacts.__name__, str(place / "install")).command,
                    limit=PACK_SECONDS,
                    cwd=Path("/"),
                    output_bytes=MAX_ARCHIVE_BYTES,
                )
                if packed.returncode is None:
                    # A timeout means that the machine was too busy, not that the build failed, because packing takes
                    # only milliseconds.
                    return BuildOutcome(None, output, late=PACK_SECONDS), False
                whole = packed.returncode == 0 and not packed.cut
                return BuildOutcome(returncode, output, packed.output if whole else b""), False
        finally:
            guard.close()
            shutil.rmtree(folder, ignore_errors=True)

    def start(self, job: ProgramJob) -> BoxedProgram:
        """Start the program in a box on the network. If the command is `ros2 run`, let the fork server start it."""
        binds = [Bind(job.sources, WORK)]
        binds += [Bind(entry / "install", HOME / name / "install") for name, entry in job.entries.items()]
        command, *words = job.command
        if self._programs and command == ros2() and words[:1] == ["run"] and not job.hidden:
            return BoxedProgram(
                self._network.ros2(self._programs, words, binds=binds, environment=job.environment)
            )
        running = self._network.start(
            job.command,
            binds=[*binds, *_covers(job.hidden, self._folder)],
            environment=job.environment,
            cwd=WORK,
            scratch=False,
        )
        return BoxedProgram(running)


class BoxedProgram:
    """A program in a box; implements :class:`autograder.workspaces.jobs.RunningProgram`."""

    def __init__(self, running: Running | WarmCommand) -> None:
        self._running = running
        self._ended = False
        self._code: int | None = None
        self._guard = BoxGuard(PROGRAM_LIMITS)
        self._guard.watch(running.pid)
        self.pid = running.pid

    def read(self, within: float) -> bytes | None:
        """Return new output of stdout and stderr; None if there is none within ``within`` seconds, b"" at the end."""
        if self._guard.exceeded():
            self._ended = True
        if self._ended:
            return b""
        data = self._running.read(within)
        if data == b"":
            self._ended = True
            self._code = self._running.exit_code()
        return data

    def exit_code(self) -> int | None:
        """Return the exit code of the program; None if it still runs or was stopped."""
        return self._code

    def interrupt(self) -> None:
        """Send Ctrl-C, but only while the program runs: later another process may have the same process id."""
        if not self._ended:
            self._running.interrupt()

    def end(self) -> None:
        """Kill the box."""
        self._guard.close()
        self._running.end()


def _covers(hidden: Sequence[Path], folder: Path) -> list[Bind]:
    """Return mounts that hide each of these files and folders behind an empty file or folder."""
    if not hidden:
        return []
    empty_folder, empty_file = folder / "empty", folder / "empty-file"
    empty_folder.mkdir(exist_ok=True)
    empty_file.touch()
    return [Bind(empty_folder if path.is_dir() else empty_file, path) for path in hidden]
