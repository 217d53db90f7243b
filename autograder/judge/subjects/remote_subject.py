"""A subject in a notebook: the kernel runs it, at the judge's word.

A Node class or a function lives in the kernel, in one participant for all of its runs. A workspace or a launch file is
started by the kernel as a process of its own each time.
"""

from __future__ import annotations

import contextlib
import secrets
import threading
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.judge.subjects.subject import InOwnProcesses
from autograder.messages import checks
from autograder.messages.lines import Hangup, Lines, NotUnderstood
from autograder.messages.workspaces import Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.graph import Endpoint
    from autograder.judge.bench.recorder import Recorder

MAX_TEXT = 4_000
"""Characters that are kept of one thing that the notebook says."""
MAX_MARKER = 200
"""Characters that are kept of the name of a marker."""
MAX_STACK = 50_000
"""Characters that are kept of a hung subject's stacks."""
MAX_SECONDS = 3600.0
"""The longest time, in seconds, that is believed when the notebook tells one; nothing of the course takes as long."""
CONSTRUCT_LIMIT = 10.0
"""Seconds of wall time after which a node whose constructor has not come to its end is no longer waited for."""
NEWS_LIMIT = 20.0
"""Seconds that a notebook's participant may take in all runs of a check to know what the judge has put up; it takes
milliseconds."""
STOP_LIMIT = 3.0
"""Seconds of wall time in which the notebook must have stopped a run."""


class RemoteSubject:
    """Implements :class:`autograder.judge.subjects.subject.Subject` over a notebook's conversation."""

    shares_participant = True

    def __init__(self, lines: Lines, *, is_class: bool = False) -> None:
        """Take over a conversation.

        Args:
            lines: The notebook's end.
            is_class: The subject is a class, whose constructor comes to its end before anything else, if it does.
        """
        # Drawn for each check, so that nobody who writes a node can have its name in it.
        self.keeper = f"_check_keeper_{secrets.token_hex(8)}"
        self._lines = lines
        self._is_class = is_class
        self._recorder: Recorder | None = None
        self._run = 0
        self._fresh = True
        self._marker: str | None = None
        self._may_make_more = False
        self._ended = False
        self._end: Callable[..., None] = lambda *_, **__: None
        self._ready = threading.Event()
        self._stopped = threading.Event()
        self._answered = threading.Event()
        self._seen_as_told = False
        self._news_left = NEWS_LIMIT
        self._gone = threading.Event()
        self._stack = ""
        self._told_stack = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)

    def begin(self, domain_id: int) -> None:
        """Let the notebook open a ROS context on the domain."""
        self._thread.start()
        self._tell(checks.Begin(domain_id, self.keeper))
        self._ready.wait(STOP_LIMIT)

    def tell_so_far(self, words: str) -> None:
        """Let the notebook's card show this while the check goes on."""
        self._tell(checks.SoFar(words))

    def renew(self) -> None:
        """Let the next run have a fresh context."""
        self._fresh = True

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Ask the notebook, which looks with its own participant."""
        self._answered.clear()
        self._seen_as_told = False
        fresh, self._fresh = self._fresh, False
        asked_at = time.monotonic()
        self._tell(checks.Meet(fresh, sorted(there), sorted(gone), max(0.0, self._news_left)))
        self._answered.wait(max(0.0, self._news_left) + STOP_LIMIT)
        self._news_left -= time.monotonic() - asked_at
        # Who has left the conversation is not kept waiting, and gets no points.
        return self._seen_as_told or self._gone.is_set()

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Let the notebook make the node (a class) or call the function."""
        self._run += 1
        self._recorder = recorder
        self._end = recorder.end_of_this_part()
        self._marker, self._may_make_more, self._ended = None, False, False
        self._stopped.clear()
        fresh, self._fresh = self._fresh, False
        sleep_factor, spare = options.pop("sleep_factor", 1.0), options.pop("spare", 0.0)
        self._tell(checks.Start(self._run, fresh, list(arguments), options, sleep_factor, spare))
        if self._is_class and not recorder.wait(
            lambda: self._marker is not None or self.ended, CONSTRUCT_LIMIT
        ):
            # It is looked at as a program is, which may do all of its work in there.
            recorder.record("subject", "never_constructed")

    def interrupt(self) -> None:
        """Let the notebook press Ctrl-C at the process of a path; what runs in the kernel goes on."""
        self._tell(checks.Interrupt(self._run))

    def release(self) -> None:
        """Let the made node spin; where it may make more, nobody knows any longer when it has made all."""
        if self._may_make_more:
            self._marker, self._may_make_more = None, False
        self._tell(checks.Release(self._run))

    @property
    def ended(self) -> bool:
        """True if the function has returned or something was raised, or the notebook is gone."""
        return self._ended or self._gone.is_set()

    def processes(self) -> frozenset[int]:
        """Nobody can tell: it runs in the notebook's kernel, beside whatever else that has started."""
        return frozenset()

    @property
    def marker(self) -> str | None:
        """The topic that the notebook made after the subject's constructor had ended."""
        return self._marker or None

    @property
    def may_make_more(self) -> bool:
        """True until the release of a node that has a timer or a thread of its own."""
        return self._may_make_more

    def stack(self) -> str:
        """Ask the notebook where the subject's threads are."""
        self._told_stack.clear()
        self._stack = ""
        self._tell(checks.Stack(self._run))
        self._told_stack.wait(STOP_LIMIT)
        return self._stack

    def stop(self) -> None:
        """Let the notebook end the run and destroy its nodes."""
        self._tell(checks.Stop(self._run))
        self._stopped.wait(STOP_LIMIT)
        self._recorder = None

    def _tell(self, message: checks.FromJudge) -> None:
        try:
            self._lines.say(message)
        except Hangup:
            self._gone.set()

    def _listen(self) -> None:
        try:
            while True:
                with contextlib.suppress(NotUnderstood):
                    self._take(self._lines.hear(checks.FromNotebook))
        except Hangup as error:
            self._gone.set()
            for event in (self._ready, self._stopped, self._answered):
                event.set()
            if self._recorder is not None:
                self._recorder.record("subject", "gone", why=str(error))

    def _take(self, message: checks.FromNotebook) -> None:
        match message:
            case checks.Ready():
                self._ready.set()
            case checks.Met(seen=seen):
                self._seen_as_told = seen
                self._answered.set()
            case checks.Check() | Source() | checks.Sources():
                pass  # these have their place before
            case _ if message.run == self._run and self._recorder is not None:
                self._take_of_run(message, self._recorder)

    def _take_of_run(self, message: checks.RunMessage, recorder: Recorder) -> None:
        record, ended = recorder.record, partial(self._note_end, message.run)
        match message:
            case checks.Stopped():
                self._stopped.set()
            case checks.Stacks(text=text):
                self._stack = text[:MAX_STACK]
                self._told_stack.set()
            case checks.Output(text=text, logged=logged):
                record("output", "notebook log" if logged else "notebook", text=text[:MAX_TEXT])
            case checks.Started(accepted=names):
                record("subject", "started", accepted=names)
            case checks.Spared(seconds=seconds):
                record("spared", "a wait for a server", seconds=_bounded(seconds))
            case checks.Called():
                record("called", "a server")
            case checks.Willing(seconds=seconds, call=call):
                record("willing", "to wait for an answer", seconds=_bounded(seconds), call=call)
            case checks.Looked():
                record("looked", "graph")
            case checks.Constructed(marker=marker, goes_on=goes_on, twin=twin):
                self._may_make_more = goes_on
                self._marker = marker[:MAX_MARKER]
                record("subject", "constructed", **({"twin": twin[:MAX_MARKER]} if twin else {}))
            case checks.Exited(code=code):
                self._end("exited", ended, code=code)
            case checks.Returned(value=value):
                shown = None if value is None else value[:MAX_TEXT]
                self._end("returned", ended, value=shown, traceback="")
            case checks.Raised(traceback=traceback):
                self._end("raised", ended, value=None, traceback=traceback[:MAX_TEXT])

    def _note_end(self, run: int) -> None:
        if run == self._run:
            self._ended = True


class RemotePath(InOwnProcesses, RemoteSubject):
    """A workspace or a launch file: the notebook's kernel starts what is in it."""

    def __init__(self, lines: Lines) -> None:
        """Take over a conversation."""
        super().__init__(lines)
        self.keeper = InOwnProcesses.keeper

    tell_so_far = RemoteSubject.tell_so_far


def _bounded(seconds: float) -> float:
    return min(max(0.0, seconds), MAX_SECONDS)  # in this order, so that NaN is 0
