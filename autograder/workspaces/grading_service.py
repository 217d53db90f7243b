"""The grader's service for checks of workspaces: it receives sources, builds them, runs programs and reports.

The service runs in the grader's executor, outside all boxes, and has two Unix sockets:

* The **judge's** socket, which the student's box cannot see. One connection is one check. The judge sends the sources
  that it got from the notebook. The service writes these into files, has them built, and runs the programs. It tells
  the judge what the workspace contains, how the build ended, which processes were started, and what the programs print.
* The **notebook's** socket, only for builds: `colcon build` in the student's box lets the service make the build.

The messages on both sockets are defined in :mod:`autograder.messages.workspace_messages`.
"""

from __future__ import annotations

import contextlib
import shutil
import socket
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from autograder import exercises
from autograder.kit.runners import Launches, LaunchesFromPackage, ServesInterface
from autograder.messages import run_messages
from autograder.messages import workspace_messages as messages
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood, listen
from autograder.safe_files import fresh_folder
from autograder.workspaces.builds.build_artifacts import pack
from autograder.workspaces.builds.cached_builds import BuildTookTooLong
from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.graded_builds import GradedBuilds
from autograder.workspaces.jobs import ProgramJob, output_lines
from autograder.workspaces.launch_watching import watched
from autograder.workspaces.packages import WORKSPACE, workspace_of
from autograder.workspaces.program_plans import course_interfaces, plan_for, ros2, single_program_command
from autograder.workspaces.program_preparation import Preparation, no_sources_line
from autograder.workspaces.sources import BadSources, receive_sources

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from autograder.kit.runners import Runner
    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import Jobs, RunningProgram
    from autograder.workspaces.program_preparation import Prepared


MAX_BUILDS = 20
"""The maximum number of builds that one notebook may request. For later builds, colcon itself runs in the box."""
PIECE = 400_000
"""The maximum number of bytes of an archive in one message."""


@dataclass(frozen=True)
class ServiceSockets:
    """The paths of the sockets on which the service listens.

    Attributes:
        judge: The socket that only the judge's box sees.
        notebook: The socket that the student's box sees; None if the notebook cannot request builds.
    """

    judge: Path
    notebook: Path | None


class WorkspaceService:
    """The service for one submission. At the end of the ``with`` block, its connections, builds and programs are ended.

    Args:
        sockets: The sockets to create, in existing folders.
        jobs: Runs builds and programs.
        builds: The folder for builds. No other process may use it.
        variables: More environment variables for programs, such as ROS settings.
        folder: A folder for sources that nothing else uses.
        ahead: The folder of builds made in advance; None if there is none.
    """

    def __init__(
        self,
        sockets: ServiceSockets,
        jobs: Jobs,
        builds: Path,
        variables: Mapping[str, str],
        folder: Path,
        ahead: Path | None = None,
    ) -> None:
        self._builds = GradedBuilds(builds, jobs, ahead)
        self._variables = variables
        self._folder = fresh_folder("sources-", folder)
        self._left = threading.Semaphore(MAX_BUILDS)
        self._conversations: set[Lines] = set()
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self._listeners = [self._open(sockets.judge, self._serve_judge)]
        if sockets.notebook is not None:
            self._listeners.append(self._open(sockets.notebook, self._serve_notebook))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.set()
        for listener in self._listeners:
            with contextlib.suppress(OSError):
                listener.shutdown(socket.SHUT_RDWR)
            listener.close()
        for conversation in list(self._conversations):
            conversation.close()
        for thread in self._threads:
            thread.join()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _open(self, path: Path, serve: Callable[[Lines, Path], None]) -> socket.socket:
        listener = listen(path)
        thread = threading.Thread(target=self._accept, args=(listener, serve), daemon=True)
        self._threads.append(thread)
        thread.start()
        return listener

    def _accept(self, listener: socket.socket, serve: Callable[[Lines, Path], None]) -> None:
        """Serve connections one after the other, so that only one check and one build runs at a time."""
        while not self._closing.is_set():
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            lines = Lines(connection)
            self._conversations.add(lines)
            if self._closing.is_set():
                lines.close()
                return
            folder = fresh_folder("c-", self._folder)
            try:
                serve(lines, folder)
            except Hangup:
                pass
            except Exception as error:
                with contextlib.suppress(Hangup):
                    lines.say(messages.Trouble(f"{type(error).__name__}: {error}"[:500]))
            finally:
                lines.close()
                self._conversations.discard(lines)
                shutil.rmtree(folder, ignore_errors=True)

    def _serve_judge(self, lines: Lines, folder: Path) -> None:
        with _WorkspaceCheck(lines, self._builds, self._variables, folder) as check:
            check.serve()

    def _serve_notebook(self, lines: Lines, folder: Path) -> None:
        """Answer one request for a build (:mod:`autograder.workspaces.builds.students_builds`)."""
        if not self._left.acquire(blocking=False):
            lines.say(messages.NotBuilt("this notebook has reached its maximum number of builds"))
            return
        try:
            order = lines.hear(messages.BuildRequest)
            receive_sources(lines, order.count, order.path, folder)
        except (BadSources, NotUnderstood) as error:
            lines.say(messages.NotBuilt(str(error)))
            return
        made = describe_workspace(folder / order.path)
        if not made.trouble:
            made = self._made(made, frozenset(order.only))
        if made.ok and made.install is not None:
            self._send(lines, made, made.install)
            return
        told = (text.replace(f"{folder}/", "") for text in (made.trouble, made.package, made.line, made.log))
        lines.say(messages.BuildFailed(made.seconds, *told))

    def _made(self, found: Build, names: frozenset[str]) -> Build:
        def targets(there: Build) -> list[str]:
            return [package.name for package in there.packages if package.name in names]

        try:
            return self._builds.build(found, targets, cancelled=self._closing.is_set)
        except BuildTookTooLong as error:
            return error.build

    def _send(self, lines: Lines, made: Build, install: Path) -> None:
        archive = pack(install)
        pieces = [archive[at : at + PIECE] for at in range(0, len(archive), PIECE)]
        place = self._builds.jobs.place(WORKSPACE, install.parent) / "install"
        lines.say(messages.BuildDone(len(pieces), str(place), made.seconds))
        for piece in pieces:
            lines.say(messages.Piece(piece))


class _WorkspaceCheck:
    """One check of a workspace or launch file, whose programs are built once but may be started several times.

    Args:
        lines: The connection to the judge.
        builds: Finds or makes the builds. Its ``jobs`` also run the programs.
        variables: Environment variables for the programs.
        folder: An empty folder that nothing else uses.
    """

    def __init__(
        self, lines: Lines, builds: GradedBuilds, variables: Mapping[str, str], folder: Path
    ) -> None:
        self._lines = lines
        self._builds = builds
        self._variables = variables
        self._tree = folder / "submitted"
        self._run: _ProgramRun | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def serve(self) -> None:
        """Carry out the judge's requests until it closes the connection.

        Raises:
            Hangup: The judge closed the connection.
        """
        first = self._lines.hear(messages.CheckRequest)
        wrong = self._take_sources(first)
        submitted = _SubmittedSources(
            exercises.get(first.exercise).runner,
            self._tree,
            first.path,
            first.trouble or wrong,
            {**self._variables, "ROS_DOMAIN_ID": str(first.domain)},
        )
        self._lines.say(run_messages.Ready())
        while True:
            order: messages.ToService = self._lines.hear(messages.ToService)
            if isinstance(order, run_messages.Interrupt):
                self._interrupt(order.run)
                continue
            # A new run may begin only after the previous one, because both would use the same ROS domain.
            self._stop()
            if isinstance(order, run_messages.Start):
                self._run = _ProgramRun(self._lines, self._builds, submitted, order)
            else:
                self._lines.say(run_messages.Stopped(order.run))

    def _take_sources(self, check: messages.CheckRequest) -> str:
        """Receive the sources, and write them into a folder. Return what is wrong with them; empty if nothing is."""
        self._tree.mkdir()
        try:
            receive_sources(self._lines, check.count, check.path, self._tree)
        except BadSources as error:
            return str(error)
        except NotUnderstood:
            return "a message that was sent as a file is not a file"
        return ""

    def _interrupt(self, number: int) -> None:
        if self._run is not None and self._run.number == number:
            self._run.interrupt()

    def _stop(self) -> None:
        run, self._run = self._run, None
        if run is not None:
            run.end()


MAX_OUTPUT = 2_000_000
"""The maximum number of characters of a run's output to pass on."""


@dataclass(frozen=True)
class _SubmittedSources:
    """The sources of a check.

    Attributes:
        runner: How the exercise runs the sources.
        tree: The folder that contains the sources.
        path: The path of the workspace or launch file in that folder.
        trouble: Why no sources were written, in words for the student; empty if they were.
        variables: More environment variables for the submitted programs.
    """

    runner: Runner | None
    tree: Path
    path: str
    trouble: str
    variables: Mapping[str, str]


class _ProgramRun:
    """One run of the submitted program, in a thread."""

    def __init__(
        self, lines: Lines, builds: GradedBuilds, submitted: _SubmittedSources, order: run_messages.Start
    ) -> None:
        self._lines = lines
        self._submitted = submitted
        self.number, self._arguments = order.run, order.arguments
        self._cancelled = threading.Event()
        self._jobs = builds.jobs
        self._prepare = Preparation(builds, self._report, self._build_ended, self._cancelled.is_set)
        self._program: RunningProgram | None = None
        self._changing = threading.Lock()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Kill the program, and wait until none of its processes is alive."""
        self._cancelled.set()
        self._thread.join()

    def interrupt(self) -> None:
        """Send Ctrl-C to the program."""
        with self._changing:
            if self._program is not None:
                self._program.interrupt()

    def _run(self) -> None:
        """Check the workspace, build it, report, run the program, and pass on its output."""
        try:
            self._work()
        except Hangup:
            pass
        except Exception as error:
            with contextlib.suppress(Hangup):
                self._lines.say(messages.Trouble(f"{type(error).__name__}: {error}"[:500]))

    def _work(self) -> None:
        what = self._submitted
        if what.trouble:
            self._report(no_sources_line(what.trouble))
            self._exited(1)
        elif what.runner is None:
            raise LookupError("this exercise takes no path")
        elif isinstance(what.runner, Launches):
            self._launch(what.tree / what.path)
        else:
            plan = plan_for(what.runner, self._arguments)
            launches = isinstance(what.runner, LaunchesFromPackage)
            self._follow(self._prepare.workspace(plan, what.tree / what.path), watch=launches)

    def _launch(self, file: Path) -> None:
        tree = self._submitted.tree
        if not file.is_file():
            self._lines.say(
                run_messages.Output(self.number, f"there is no launch file {self._submitted.path}")
            )
            self._exited(1)
            return
        workspace = workspace_of(file, (file.parent, tree))
        if workspace is not None and not workspace.is_relative_to(tree):
            workspace = None
        seen = self._jobs.tree(tree) / file.relative_to(tree)
        command = single_program_command(self._arguments) or [ros2(), "launch", str(seen)]
        self._follow(self._prepare.launch(command, file, workspace), watch=True)

    def _follow(self, prepared: Prepared | None, *, watch: bool = False) -> None:
        """Run a program until it ends or is no longer needed."""
        if prepared is None:
            self._exited(1)
            return
        folders = {name: one.install.parent for name, one in prepared.builds.items() if one.install}
        variables = {**prepared.environment, **self._submitted.variables}
        # If students have to write the interface themselves, hide the course's own interfaces from the program.
        hidden = course_interfaces() if isinstance(self._submitted.runner, ServesInterface) else ()
        program = self._jobs.start(
            ProgramJob(prepared.command, variables, self._submitted.tree, folders, hidden)
        )
        with self._changing:
            self._program = program
        try:
            with watched(program.pid, self._report) if watch else contextlib.nullcontext():
                self._pass_on(program)
        finally:
            with self._changing:
                self._program = None
            program.end()
        if not self._cancelled.is_set():
            self._exited(program.exit_code())

    def _pass_on(self, program: RunningProgram) -> None:
        left = MAX_OUTPUT
        for text in output_lines(program, lambda: not self._cancelled.is_set()):
            left -= len(text) + 1  # count the line's end, so that empty lines use up the limit, too
            if left > 0:
                self._lines.say(run_messages.Output(self.number, text))

    def _report(self, line: str) -> None:
        """Send the judge a line of the report, with paths changed to those in the notebook's folder."""
        tree = self._submitted.tree
        text = line.replace(f"{tree}/", "").replace(str(tree), ".")
        self._lines.say(messages.ReportLine(self.number, text))

    def _build_ended(self) -> None:
        self._lines.say(messages.BuildEnded(self.number))

    def _exited(self, code: int | None) -> None:
        self._lines.say(run_messages.Exited(self.number, code))
