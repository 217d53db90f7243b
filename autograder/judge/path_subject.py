"""A workspace or launch file of a notebook as a subject: the grader's side builds and runs it, and reports.

The notebook sends its sources and has no further part in it. What it said about them becomes files on the grader's
side (:mod:`autograder.workspaces.service`); from there come the reports, and what the programs say.
"""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from autograder.exercises.evidence import REPORTS
from autograder.judge.wire import JudgeFailed
from autograder.workspaces.lines import Hangup, Lines
from autograder.workspaces.sources import MAX_BYTES, MAX_FILES, BadSources, Source, checked, from_words

if TYPE_CHECKING:
    from autograder.judge.link import Link
    from autograder.judge.recorder import Recorder

STOP_LIMIT = 15.0
"""Seconds of wall time in which the grader's side must have ended a run."""
PATIENCE = 60.0
"""Seconds of wall time after which a scenario that has given up on a build had waited for it. One that gives up earlier
has seen enough."""
MAX_TEXT = 4_000
"""Characters that are kept of one line."""


class PathSubject:
    """Implements :class:`autograder.judge.subjects.Subject` over the link and the grader's door.

    Attributes:
        trouble: Why nothing can be said about what was submitted, where the grader's side failed; else empty.
    """

    shares_participant = False
    marker = None

    def __init__(self, link: Link, exercise: str, door: str) -> None:
        """Take over a conversation.

        Args:
            link: The notebook's end.
            exercise: The exercise's id.
            door: The socket of the grader's side.
        """
        self._link = link
        self._exercise = exercise
        self._door = door
        self._lines: Lines | None = None
        self._path = ""
        self._run = 0
        self._recorder: Recorder | None = None
        self._ended = threading.Event()
        self._stopped = threading.Event()
        self._ready = threading.Event()
        self._built = threading.Event()
        self._began = 0.0
        self.trouble = ""

    def begin(self, domain_id: int) -> None:
        """Take the sources and hand them over; from then on the notebook stands still.

        Raises:
            JudgeFailed: The grader's side is not there.
            LinkClosed: The notebook hung up before it had sent everything.
        """
        sources, wrong = self._collected()
        try:
            self._lines = Lines.to(self._door)
            self._lines.say(
                "check",
                exercise=self._exercise,
                domain=domain_id,
                path=self._path,
                count=len(sources),
                trouble=wrong,
            )
            for source in sources:
                self._lines.say("source", **source.as_words())
        except Hangup as error:
            raise JudgeFailed(f"the grader's side of workspaces is gone: {error}") from error
        threading.Thread(target=self._listen, args=(self._lines,), daemon=True).start()
        self._ready.wait()
        self._check()

    def renew(self) -> None:
        """Each run is a process of its own, with a participant of its own."""

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Let it be built, where it is not yet, and run.

        Raises:
            JudgeFailed: The grader's side is gone.
        """
        del arguments, options
        self._run += 1
        self._recorder = recorder
        self._ended.clear()
        self._stopped.clear()
        self._built.clear()
        self._began = time.monotonic()
        self._say("start")

    def release(self) -> None:
        """A program runs from its start."""

    @property
    def ended(self) -> bool:
        """Whether this run has ended by itself, or there is nobody left to run it."""
        return self._ended.is_set()

    def stack(self) -> str:
        """Nobody can tell: the program is not this process's child."""
        return ""

    def stop(self) -> None:
        """Let the run be ended.

        Raises:
            JudgeFailed: Something failed on the grader's side, so that what was seen says nothing.
        """
        if self._recorder is None:
            return
        self._recorder = None
        waited = not self._built.is_set() and not self.ended and time.monotonic() - self._began > PATIENCE
        if not self.trouble:
            self._say("stop")
            if not self._stopped.wait(STOP_LIMIT):
                raise JudgeFailed("the grader's side did not end what it ran")
        if waited:
            raise JudgeFailed("the build did not end in time; is the machine too busy?")
        self._check()

    def _check(self) -> None:
        if self.trouble:
            raise JudgeFailed(self.trouble)

    def _say(self, word: str) -> None:
        assert self._lines is not None
        try:
            self._lines.say(word, run=self._run, path=self._path)
        except Hangup as error:
            raise JudgeFailed(self.trouble or f"the grader's side of workspaces is gone: {error}") from error

    def _collected(self) -> tuple[list[Source], str]:
        """What the notebook sends as its sources, and what is wrong with it."""
        self._link.send("collect")
        sources: list[Source] = []
        size = 0
        while (words := self._link.receive())["say"] != "sources":
            try:
                if words["say"] == "source" and len(sources) <= MAX_FILES and size <= MAX_BYTES:
                    sources.append(from_words(words))
                    size += len(sources[-1].data or b"")
            except BadSources as error:
                return [], str(error)
        wrong = "".join(c for c in str(words.get("trouble") or "")[:500] if c.isprintable())
        try:
            self._path = checked([Source(str(words.get("path")))])[0].path
            return checked(sources), wrong
        except BadSources as error:
            return [], wrong or str(error)

    def _listen(self, lines: Lines) -> None:
        try:
            while True:
                self._take(lines.hear())
        except Hangup as error:
            self._fail(f"the grader's side of workspaces is gone: {error}")

    def _take(self, words: dict[str, Any]) -> None:
        say, recorder, text = words["say"], self._recorder, str(words.get("text"))
        if say == "trouble":
            self._fail(str(words["why"]))
        elif say == "ready":
            self._ready.set()
        elif words.get("run") != self._run:
            return  # of an earlier run
        elif say == "stopped":
            self._stopped.set()
        elif say == "built":
            self._built.set()
        elif recorder is None:
            return
        elif say == "report":
            recorder.record("output", "report", text=text)
        elif say == "output":
            recorder.record("output", "stdout", text=as_words(text))
        elif say == "exited":
            self._ended.set()
            recorder.record("subject", "exited", code=words.get("code"))

    def _fail(self, why: str) -> None:
        self.trouble = self.trouble or why
        for event in (self._ended, self._stopped, self._ready):
            event.set()
        if self._recorder is not None:
            self._recorder.record("subject", "gone")


def as_words(text: str) -> str:
    """A line as a program's own words: whatever it begins with, it is none of a runner's reports."""
    return f" {text[:MAX_TEXT]}" if text.startswith(REPORTS) else text[:MAX_TEXT]
