"""A workspace or launch file as the subject of a notebook's check, built and run by the grader's workspace service.

The notebook sends only the sources. The workspace service (:mod:`autograder.workspaces.grading_service`) writes them to
files, builds and runs them, and sends the judge its reports and the programs' output.
"""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from autograder.judge.machine_fitness import JudgeFailed
from autograder.judge.subject import InOwnProcesses
from autograder.kit.output.spoken_lines import REPORTS
from autograder.messages import run_messages, workspace_messages
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood
from autograder.messages.judge_messages import Collect, FromNotebook, Sources
from autograder.messages.workspace_messages import Source
from autograder.workspaces.sources import (
    MAX_FILES,
    MAX_HELD,
    BadSources,
    check_path,
    checked_sources,
    room_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.recorder import Recorder


STOP_LIMIT = 15.0
"""Time limit in seconds of wall time for the workspace service to end a run."""
PATIENCE = 60.0
"""The minimum time that a scenario waits for a build, in seconds of wall time. If the scenario stops later and the
build is still running, the build took too long. If the scenario stops earlier, it did not need the build.
"""
MAX_TEXT = 4_000
"""The maximum length of a line, in characters."""


class PathSubject(InOwnProcesses):
    """A workspace or launch file that the grader's workspace service builds and runs.

    Attributes:
        trouble: Why the workspace service failed, as a text for people; empty if it did not fail.
    """

    def __init__(self, notebook: Lines, exercise: str, socket_path: str) -> None:
        """Prepare to judge a workspace or launch file.

        Args:
            notebook: The open connection to the notebook, which sends the sources.
            exercise: The exercise's id.
            socket_path: The socket of the workspace service.
        """
        self._notebook = notebook
        self._exercise = exercise
        self._socket = socket_path
        self._lines: Lines | None = None
        self._path = ""
        self._run = 0
        self._recorder: Recorder | None = None
        self._end: Callable[..., None] = lambda *_, **__: None
        self._ended = threading.Event()
        self._stopped = threading.Event()
        self._ready = threading.Event()
        self._built = threading.Event()
        self._began = 0.0
        self.trouble = ""

    def begin(self, domain_id: int) -> None:
        """Receive the sources from the notebook and pass them to the workspace service.

        Raises:
            JudgeFailed: The workspace service does not answer.
            Hangup: The notebook disconnected before it had sent all sources.
        """
        sources, wrong = self._collected()
        try:
            self._lines = Lines.to(self._socket)
            self._lines.say(
                workspace_messages.CheckRequest(
                    self._exercise, domain_id, self._path, len(sources), trouble=wrong
                )
            )
            for source in sources:
                self._lines.say(source)
        except Hangup as error:
            raise JudgeFailed(f"the grader's workspace service is gone: {error}") from error
        threading.Thread(target=self._listen, args=(self._lines,), daemon=True).start()
        self._ready.wait()
        self._check()

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Have the workspace service run the subject, and build a workspace first unless it is built already.

        Raises:
            JudgeFailed: The workspace service has ended.
        """
        del options
        self._run += 1
        self._recorder = recorder
        self._end = recorder.end
        self._ended.clear()
        self._stopped.clear()
        self._built.clear()
        self._began = time.monotonic()
        self._say(run_messages.Start(self._run, list(map(str, arguments))))

    def release(self) -> None:
        """Do nothing, because a program runs from its start on."""

    def interrupt(self) -> None:
        """Have the workspace service send Ctrl-C to the program."""
        self._say(run_messages.Interrupt(self._run))

    @property
    def ended(self) -> bool:
        """True if this run has ended by itself, or the workspace service has ended."""
        return self._ended.is_set()

    def stack(self) -> str:
        """Return an empty text: the program is not a child of this process, so its stacks are unknown."""
        return ""

    def stop(self) -> None:
        """Have the workspace service end the run.

        Raises:
            JudgeFailed: The workspace service failed, so the evidence proves nothing.
        """
        if self._recorder is None:
            return
        self._recorder = None
        waited = not self._built.is_set() and not self.ended and time.monotonic() - self._began > PATIENCE
        if not self.trouble:
            self._say(run_messages.Stop(self._run))
            if not self._stopped.wait(STOP_LIMIT):
                raise JudgeFailed("the grader's workspace service did not end the run")
        if waited:
            raise JudgeFailed("the build did not end in time; is the machine too busy?")
        self._check()

    def _check(self) -> None:
        if self.trouble:
            raise JudgeFailed(self.trouble)

    def _say(self, message: workspace_messages.ToService) -> None:
        assert self._lines is not None
        try:
            self._lines.say(message)
        except Hangup as error:
            raise JudgeFailed(self.trouble or f"the grader's workspace service is gone: {error}") from error

    def _collected(self) -> tuple[list[Source], str]:
        """Return the sources that the notebook sends, and the reason if they cannot be used."""
        self._notebook.say(Collect())
        sources: list[Source] = []
        room = MAX_HELD
        try:
            while not isinstance(said := self._notebook.hear(FromNotebook), Sources):
                if isinstance(said, Source) and len(sources) <= MAX_FILES and room >= 0:
                    sources.append(said)
                    room -= room_of(said)
        except NotUnderstood:
            return [], "the notebook sent a message that is not a file"
        wrong = "".join(c for c in said.trouble[:500] if c.isprintable())
        try:
            check_path(said.path)
            self._path = said.path
            return checked_sources(sources), wrong
        except BadSources as error:
            return [], wrong or str(error)

    def _listen(self, lines: Lines) -> None:
        try:
            while True:
                self._take(lines.hear(workspace_messages.FromService))
        except (Hangup, NotUnderstood) as error:
            self._fail(f"the grader's workspace service is gone: {error}")

    def _take(self, message: workspace_messages.FromService) -> None:
        match message:
            case workspace_messages.Trouble(why=why):
                self._fail(why)
            case run_messages.Ready():
                self._ready.set()
            case _ if message.run != self._run:
                pass  # a message about an earlier run
            case run_messages.Stopped():
                self._stopped.set()
            case workspace_messages.BuildEnded():
                self._built.set()
            case _ if self._recorder is not None:
                self._record(message, self._recorder.record)

    def _record(self, message: workspace_messages.FromService, record: Callable[..., None]) -> None:
        match message:
            case workspace_messages.ReportLine(text=text):
                record("output", "report", text=text)
            case run_messages.Output(text=text):
                record("output", "stdout", text=as_words(text))
            case run_messages.Exited(code=code):
                self._end("exited", self._ended.set, code=code)

    def _fail(self, why: str) -> None:
        self.trouble = self.trouble or why
        for event in (self._ended, self._stopped, self._ready):
            event.set()
        if self._recorder is not None:
            self._recorder.record("subject", "gone")


def as_words(text: str) -> str:
    """Return a line of a program's output. If it looks like a report of the runner, put a space before it."""
    return f" {text[:MAX_TEXT]}" if text.startswith(REPORTS) else text[:MAX_TEXT]
