"""One check of a workspace or a launch file, on the grader's side."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Self

from autograder import exercises
from autograder.kit.runners import Launches, ServesInterface
from autograder.messages import workspaces as messages
from autograder.messages.lines import Hangup, NotUnderstood
from autograder.workspaces.jobs import ProgramJob
from autograder.workspaces.running.plans import course_interfaces, plan_for, ros2
from autograder.workspaces.running.preparing import COURSE, Preparation
from autograder.workspaces.running.processes import watched
from autograder.workspaces.running.reporting import no_sources_line
from autograder.workspaces.sources.collecting import receive
from autograder.workspaces.sources.finding import workspace_of
from autograder.workspaces.sources.tree import BadSources

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.kit.runners import Runner
    from autograder.messages.lines import Lines
    from autograder.workspaces.building.colcon import Build, Targets
    from autograder.workspaces.building.trusted import TrustedBuilds
    from autograder.workspaces.jobs import Jobs, Program
    from autograder.workspaces.running.preparing import Prepared

MAX_LINE = 4_000
"""Bytes of one line of a program's output that are kept."""
MAX_OUTPUT = 2_000_000
"""Bytes of output that are passed on of one run."""


class Session:
    """One check. The judge may start what was submitted several times; it is built once.

    Args:
        lines: The judge's end.
        jobs: Builds and runs.
        builds: The cache.
        variables: Of the programs' environment.
        folder: Empty, ours alone.
    """

    def __init__(
        self, lines: Lines, jobs: Jobs, builds: TrustedBuilds, variables: Mapping[str, str], folder: Path
    ) -> None:
        self._lines = lines
        self._jobs = jobs
        self._builds = builds
        self._variables = variables
        self._tree = folder / "submitted"
        self._run: _Run | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def serve(self) -> None:
        """Do what the judge says until it hangs up.

        Raises:
            Hangup: It did.
        """
        first = self._lines.hear(messages.Check)
        runner = exercises.get(first.exercise).runner
        wrong = self._take_sources(first)
        trouble = first.trouble or wrong
        self._lines.say(messages.Ready())
        variables = {**self._variables, "ROS_DOMAIN_ID": str(first.domain)}
        while True:
            order: messages.ToService = self._lines.hear(messages.ToService)
            if isinstance(order, messages.Interrupt):
                self._interrupt(order.run)
                continue
            self._stop()
            if isinstance(order, messages.Start):
                self._run = _Run(self, runner, first.path, trouble, order, variables)
            else:
                self._lines.say(messages.Stopped(order.run))

    def _take_sources(self, check: messages.Check) -> str:
        """Write down what was submitted; what is wrong with it, if anything is."""
        self._tree.mkdir()
        try:
            receive(self._lines, check.count, check.path, self._tree)
        except BadSources as error:
            return str(error)
        except NotUnderstood:
            return "a file has not the form of one"
        return ""

    def _interrupt(self, number: int) -> None:
        if self._run is not None and self._run.number == number:
            self._run.interrupt()

    def _stop(self) -> None:
        run, self._run = self._run, None
        if run is not None:
            run.end()


class _Run(Preparation):
    """One start of what was submitted, until it ends or is ended."""

    def __init__(
        self,
        session: Session,
        runner: Runner | None,
        path: str,
        trouble: str,
        order: messages.Start,
        variables: Mapping[str, str],
    ) -> None:
        super().__init__(session._jobs.environment)
        self._lines, self._jobs, self._builds = session._lines, session._jobs, session._builds
        self._tree = session._tree
        self._runner, self._path, self._trouble = runner, path, trouble
        self.number, self._arguments = order.run, order.arguments
        self._variables = dict(variables)
        self._cancelled = threading.Event()
        self._program: Program | None = None
        self._changing = threading.Lock()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Kill what runs, and wait until nothing of it is left."""
        self._cancelled.set()
        self._thread.join()

    def interrupt(self) -> None:
        """Press Ctrl-C at what runs, where it runs."""
        with self._changing:
            if self._program is not None:
                self._program.interrupt()

    def _run(self) -> None:
        """Look, build, report, run, tell."""
        try:
            self._work()
        except Hangup:
            pass
        except Exception as error:
            self._lines.say(messages.Trouble(f"{type(error).__name__}: {error}"[:500]))

    def _work(self) -> None:
        if self._trouble:
            self.report(no_sources_line(self._trouble))
            self._exited(1)
        elif self._runner is None:
            raise LookupError("this exercise takes no path")
        elif isinstance(self._runner, Launches):
            self._launch(self._tree / self._path)
        else:
            plan = plan_for(self._runner, self._arguments)
            self._follow(self.workspace(plan, self._tree / self._path))

    def _launch(self, file: Path) -> None:
        if not file.is_file():
            self._lines.say(messages.Output(self.number, f"there is no launch file {self._path}"))
            self._exited(1)
            return
        workspace = workspace_of(file, (file.parent, self._tree))
        if workspace is not None and not workspace.is_relative_to(self._tree):
            workspace = None
        seen = self._jobs.tree(self._tree) / file.relative_to(self._tree)
        prepared = self.launch([ros2(), "launch", str(seen)], file, workspace)
        self._follow(prepared, watch=True)

    def _hidden(self) -> Sequence[Path]:
        """The course's own interfaces that a task is to make, hidden so that they cannot be copied."""
        return course_interfaces() if isinstance(self._runner, ServesInterface) else ()

    def _follow(self, prepared: Prepared | None, *, watch: bool = False) -> None:
        """Run a program to its end, or until nobody wants it any more."""
        if prepared is None:
            self._exited(1)
            return
        folders = {name: one.install.parent for name, one in prepared.builds.items() if one.install}
        variables = {**prepared.environment, **self._variables}
        program = self._jobs.start(
            ProgramJob(prepared.command, variables, self._tree, folders, self._hidden())
        )
        with self._changing:
            self._program = program
        try:
            with watched(program.pid, self.report) if watch else contextlib.nullcontext():
                self._pass_on(program)
        finally:
            with self._changing:
                self._program = None
            program.end()
        if not self._cancelled.is_set():
            self._exited(program.exit_code())

    def _pass_on(self, program: Program) -> None:
        """Pass on its output, line by line, as long as it is wanted."""
        left, line = MAX_OUTPUT, b""
        while not self._cancelled.is_set() and (data := program.read(0.1)) != b"":
            *complete, line = (line + (data or b"")).split(b"\n")
            for text in complete:
                left -= min(len(text), MAX_LINE) + 1  # an empty line has to be sent, too
                if left > 0:
                    self._say_output(text)
            line = line[:MAX_LINE]
        if line and left > 0:
            self._say_output(line)

    def _say_output(self, line: bytes) -> None:
        text = line[:MAX_LINE].decode("utf-8", "replace").rstrip("\r")
        self._lines.say(messages.Output(self.number, text))

    def build(self, found: Build, targets: Targets | None, name: str) -> Build:
        """Let it be built by the jobs; the course's own packages must be.

        Raises:
            RuntimeError: They could not.
        """
        if name != COURSE:
            return self._builds.build(found, targets, name=name, cancelled=self._cancelled.is_set)
        made = self._builds.build(found, targets, name=name)
        if not made.ok:
            raise RuntimeError(f"the course's own packages could not be built: {made.line}")
        return made

    def place(self, name: str, entry: Path) -> Path:
        """The path at which the jobs see it."""
        return self._jobs.place(name, entry)

    def report(self, line: str) -> None:
        """Tell it to the judge."""
        text = line.replace(f"{self._tree}/", "").replace(str(self._tree), ".")
        self._lines.say(messages.ReportLine(self.number, text))

    def built(self, line: str) -> None:
        """Tell the judge before that it waits for no build any more."""
        self._lines.say(messages.BuildEnded(self.number))
        self.report(line)

    def _exited(self, code: int | None) -> None:
        self._lines.say(messages.Exited(self.number, code))
