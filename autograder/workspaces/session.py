"""One check of a workspace or a launch file, on the grader's side."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any, Self

from autograder import exercises
from autograder.exercises.launch_report import process_line
from autograder.workspaces import sources
from autograder.workspaces.building import look
from autograder.workspaces.finding import WORKSPACE, workspace_of
from autograder.workspaces.launching import watch_processes
from autograder.workspaces.lines import Hangup
from autograder.workspaces.plans import (
    PLANS,
    course_interfaces,
    lacks_programs,
    launch_targets,
    reference_workspace,
    ros2,
)
from autograder.workspaces.prefixes import relocated, with_prefixes
from autograder.workspaces.reporting import built_line, found_line, no_sources_line

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from autograder.exercises.model import Exercise
    from autograder.workspaces.building import Build
    from autograder.workspaces.jobs import Jobs, Program
    from autograder.workspaces.lines import Lines
    from autograder.workspaces.plans import Plan
    from autograder.workspaces.trusted_build import TrustedBuilds

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
        self._open = contextlib.ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._stop()
        finally:
            self._open.close()

    def serve(self) -> None:
        """Do what the judge says until it hangs up.

        Raises:
            Hangup: It did.
        """
        first = self._lines.hear()
        exercise = exercises.get(str(first["exercise"]))
        trouble = self._take_sources(int(first["count"])) or str(first.get("trouble", ""))
        # From here on nothing of the student's moves but what is started here.
        self._open.enter_context(self._jobs.standstill())
        self._lines.say("ready")
        variables = {**self._variables, "ROS_DOMAIN_ID": str(int(first["domain"]))}
        while True:
            words = self._lines.hear()
            number = int(words["run"])
            self._stop()
            if words["say"] == "start":
                self._run = _Run(self, exercise, str(first["path"]), trouble, number, variables)
            else:
                self._lines.say("stopped", run=number)

    def _take_sources(self, count: int) -> str:
        """Write down what was submitted; what is wrong with it, if anything is."""
        self._tree.mkdir()
        try:
            if count > sources.MAX_FILES:
                raise sources.BadSources("there is too much in src")
            taken = [sources.from_words(self._lines.hear()) for _ in range(count)]
            sources.write(sources.checked(taken), self._tree)
        except sources.BadSources as error:
            return str(error)
        return ""

    def _stop(self) -> None:
        run, self._run = self._run, None
        if run is not None:
            run.end()


class _Run(threading.Thread):
    """One start of what was submitted, until it ends or is ended."""

    def __init__(
        self,
        session: Session,
        exercise: Exercise,
        path: str,
        trouble: str,
        number: int,
        variables: Mapping[str, str],
    ) -> None:
        super().__init__(daemon=True)
        self._lines, self._jobs, self._builds = session._lines, session._jobs, session._builds
        self._tree = session._tree
        self._exercise, self._path, self._trouble = exercise, path, trouble
        self._number = number
        self._variables = dict(variables)
        self._cancelled = threading.Event()
        self._program: Program | None = None
        self._changing = threading.Lock()
        self.start()

    def end(self) -> None:
        """Kill what runs, and wait until nothing of it is left."""
        self._cancelled.set()
        self.join()

    def run(self) -> None:
        """Look, build, report, run, tell."""
        try:
            self._work()
        except Hangup:
            pass
        except Exception as error:
            self._say("trouble", why=f"{type(error).__name__}: {error}"[:500])

    def _work(self) -> None:
        if self._trouble:
            self._report(no_sources_line(self._trouble))
            self._say("exited", code=1)
        elif self._exercise.runner == "launch":
            self._launch(self._tree / self._path)
        else:
            self._workspace(PLANS[self._exercise.runner])

    def _workspace(self, plan: Plan) -> None:
        found = look(self._tree / self._path)
        self._report(found_line(found))
        made = found
        if not found.trouble:
            made = self._builds.build(found, plan.targets, name=WORKSPACE, cancelled=self._cancelled.is_set)
        missing = plan.missing(made) if made.ok else ""
        self._say("built")
        self._report(built_line(made, missing))
        if not made.ok or missing:
            self._say("exited", code=1)
            return
        self._follow(plan.command(made), self._environment(made), {WORKSPACE: made})

    def _launch(self, file: Path) -> None:
        if not file.is_file():
            self._say("output", text=f"there is no launch file {self._path}")
            self._say("exited", code=1)
            return
        entries = {COURSE: self._course_build()}
        workspace = workspace_of(file, (file.parent, self._tree))
        environment, first = self._jobs.environment, False
        if workspace is not None and workspace.is_relative_to(self._tree):
            made = self._builds.build(
                look(workspace), launch_targets(file), name=WORKSPACE, cancelled=self._cancelled.is_set
            )
            self._say("built")
            self._report(built_line(made))
            if not made.ok:
                self._say("exited", code=1)
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
        return course_interfaces() if self._exercise.runner == "interface" else ()

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
        program = self._jobs.start(
            command,
            {**environment, **self._variables},
            sources=self._tree,
            entries=folders,
            hidden=self._hidden(),
        )
        ended = threading.Event()
        watcher = threading.Thread(
            target=watch_processes,
            args=(program.pid, ended, lambda argv: self._report(process_line(argv))),
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
            program.end()
        if not self._cancelled.is_set():
            self._say("exited", code=program.exit_code())

    def _pass_on(self, program: Program) -> None:
        """What it says, line by line, as long as it is wanted."""
        left, line = MAX_OUTPUT, b""
        while not self._cancelled.is_set() and (data := program.read(0.1)) != b"":
            data = (data or b"")[:left]
            left -= len(data)
            *complete, line = (line + data).split(b"\n")
            for text in (*complete, line) if len(line) > MAX_LINE else complete:
                self._say_output(text)
            line = b"" if len(line) > MAX_LINE else line
        if line:
            self._say_output(line)

    def _say_output(self, line: bytes) -> None:
        self._say("output", text=line[:MAX_LINE].decode("utf-8", "replace").rstrip("\r"))

    def _report(self, line: str) -> None:
        self._say("report", text=line.replace(f"{self._tree}/", "").replace(str(self._tree), "."))

    def _say(self, word: str, **rest: Any) -> None:
        self._lines.say(word, run=self._number, **rest)
