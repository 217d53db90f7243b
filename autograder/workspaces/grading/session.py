"""One check of a workspace or a launch file, on the grader's side."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Self

from autograder import exercises
from autograder.kit.launch_report import process_line
from autograder.kit.runners import Launches, ServesInterface
from autograder.messages import workspaces as messages
from autograder.messages.lines import Hangup, NotUnderstood
from autograder.workspaces.building.colcon import look
from autograder.workspaces.grading.jobs import ProgramJob
from autograder.workspaces.running.launching import watch_processes
from autograder.workspaces.running.plans import (
    course_interfaces,
    lacks_programs,
    launch_targets,
    plan_for,
    reference_workspace,
    ros2,
)
from autograder.workspaces.running.prefixes import relocated, with_prefixes
from autograder.workspaces.running.reporting import built_line, found_line, no_sources_line
from autograder.workspaces.sources import collecting
from autograder.workspaces.sources.finding import WORKSPACE, workspace_of
from autograder.workspaces.sources.tree import BadSources, Tree

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.kit.runners import Runner
    from autograder.messages.lines import Lines
    from autograder.workspaces.building.result import Build
    from autograder.workspaces.building.trusted import TrustedBuilds
    from autograder.workspaces.grading.jobs import Jobs, Program
    from autograder.workspaces.running.plans import Plan

COURSE = "course_ws"
"""The place of the course's own packages, behind the student's."""
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
            if check.count > collecting.MAX_FILES:
                raise BadSources("there is too much in src")
            taken = [self._lines.hear(messages.Source) for _ in range(check.count)]
            collecting.check_path(check.path)
            Tree(tuple(collecting.checked(taken))).write(self._tree)
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


class _Run(threading.Thread):
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
        super().__init__(daemon=True)
        self._lines, self._jobs, self._builds = session._lines, session._jobs, session._builds
        self._tree = session._tree
        self._runner, self._path, self._trouble = runner, path, trouble
        self.number, self._arguments = order.run, order.arguments
        self._variables = dict(variables)
        self._cancelled = threading.Event()
        self._program: Program | None = None
        self._changing = threading.Lock()
        self.start()

    def end(self) -> None:
        """Kill what runs, and wait until nothing of it is left."""
        self._cancelled.set()
        self.join()

    def interrupt(self) -> None:
        """Press Ctrl-C at what runs, where it runs."""
        with self._changing:
            if self._program is not None:
                self._program.interrupt()

    def run(self) -> None:
        """Look, build, report, run, tell."""
        try:
            self._work()
        except Hangup:
            pass
        except Exception as error:
            self._lines.say(messages.Trouble(f"{type(error).__name__}: {error}"[:500]))

    def _work(self) -> None:
        if self._trouble:
            self._report(no_sources_line(self._trouble))
            self._exited(1)
        elif self._runner is None:
            raise LookupError("this exercise takes no path")
        elif isinstance(self._runner, Launches):
            self._launch(self._tree / self._path)
        else:
            self._workspace(plan_for(self._runner, self._arguments))

    def _workspace(self, plan: Plan) -> None:
        found = look(self._tree / self._path)
        self._report(found_line(found, plan))
        made = found
        if not found.trouble:
            made = self._builds.build(found, plan.targets, name=WORKSPACE, cancelled=self._cancelled.is_set)
        missing = plan.missing(made) if made.ok else ""
        self._lines.say(messages.BuildEnded(self.number))
        self._report(built_line(made, plan, missing))
        if not made.ok or missing:
            self._exited(1)
            return
        self._follow(plan.command(made), self._environment(made), {WORKSPACE: made})

    def _launch(self, file: Path) -> None:
        if not file.is_file():
            self._lines.say(messages.Output(self.number, f"there is no launch file {self._path}"))
            self._exited(1)
            return
        entries = {COURSE: self._course_build()}
        workspace = workspace_of(file, (file.parent, self._tree))
        environment, first = self._jobs.environment, False
        if workspace is not None and workspace.is_relative_to(self._tree):
            made = self._builds.build(
                look(workspace), launch_targets(file), name=WORKSPACE, cancelled=self._cancelled.is_set
            )
            self._lines.say(messages.BuildEnded(self.number))
            self._report(built_line(made))
            if not made.ok:
                self._exited(1)
                return
            entries[WORKSPACE] = made
            first = lacks_programs(file, made, entries[COURSE])
            environment = self._environment(made)
        environment = self._environment(entries[COURSE], environment, name=COURSE, last=not first)
        seen = self._jobs.tree(self._tree) / file.relative_to(self._tree)
        self._follow([ros2(), "launch", str(seen)], environment, entries, watch=True)

    def _course_build(self) -> Build:
        made = self._builds.build(look(reference_workspace()), None, name=COURSE)
        if not made.ok:
            raise RuntimeError(f"the course's own packages could not be built: {made.line}")
        return made

    def _hidden(self) -> Sequence[Path]:
        """Where the task is to make interfaces, those that came with the course are not there to be copied."""
        return course_interfaces() if isinstance(self._runner, ServesInterface) else ()

    def _environment(
        self,
        made: Build,
        base: Mapping[str, str] | None = None,
        *,
        name: str = WORKSPACE,
        last: bool = False,
    ) -> Mapping[str, str]:
        """An environment in which a build is found, by somebody who sees it at its place."""
        assert made.install is not None
        entry = made.install.parent
        environment = with_prefixes(base or self._jobs.environment, made.prefixes, last=last)
        return relocated(environment, entry, self._jobs.place(name, entry))

    def _follow(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        entries: Mapping[str, Build],
        *,
        watch: bool = False,
    ) -> None:
        """Run a program to its end, or until nobody wants it any more."""
        folders = {name: made.install.parent for name, made in entries.items() if made.install is not None}
        variables = {**environment, **self._variables}
        program = self._jobs.start(ProgramJob(command, variables, self._tree, folders, self._hidden()))
        with self._changing:
            self._program = program
        ended = threading.Event()
        watcher = threading.Thread(
            target=watch_processes,
            args=(program.pid, ended, lambda process: self._report(process_line(process))),
            daemon=True,
        )
        if watch:
            watcher.start()
        try:
            self._pass_on(program)
        finally:
            ended.set()
            if watch:
                watcher.join()
            with self._changing:
                self._program = None
            program.end()
        if not self._cancelled.is_set():
            self._exited(program.exit_code())

    def _pass_on(self, program: Program) -> None:
        """What it says, line by line, as long as it is wanted."""
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

    def _report(self, line: str) -> None:
        text = line.replace(f"{self._tree}/", "").replace(str(self._tree), ".")
        self._lines.say(messages.ReportLine(self.number, text))

    def _exited(self, code: int | None) -> None:
        self._lines.say(messages.Exited(self.number, code))
