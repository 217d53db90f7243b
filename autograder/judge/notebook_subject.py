"""A subject that a notebook's kernel runs when the judge requests it.

If the subject is a Node class or a function, it runs inside the kernel, with the same DDS participant in all runs. If
the subject is a workspace or a launch file, the kernel starts a new process for each run.
"""

from __future__ import annotations

import contextlib
import secrets
import threading
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.judge.subject import InOwnProcesses
from autograder.kit.mistakes.hangs import LOOPS
from autograder.kit.output.workspace_reports import tells_of_a_build
from autograder.messages import judge_messages, run_messages
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood
from autograder.messages.workspace_messages import Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.discovery import Endpoint
    from autograder.judge.bench.recorder import Recorder
    from autograder.verdict import Verdict


MAX_TEXT = 4_000
"""The maximum length of a text from the notebook, in characters."""
MAX_MARKER = 200
"""The maximum length, in characters, of the name of the topic that shows that all endpoints are made."""
MAX_STACK = 50_000
"""The maximum length of the stacks of a hung subject, in characters."""
CONSTRUCT_LIMIT = 10.0
"""Seconds of wall time that a node's constructor may take before the judge stops waiting for it."""
NEWS_LIMIT = 20.0
"""Time limit in seconds, for all runs of a check together, for a notebook's participant to discover the judge's
endpoints. It usually takes milliseconds.
"""
MAX_OWN_LINES = 2_000
"""The maximum number of lines of the student's code that a notebook may claim."""
LOOP_LIMIT, ASK_AGAIN = 20.0, 0.5
"""Time limit in seconds of wall time for finding out whether the subject is in a loop, and the time between two
questions.
"""
STOP_LIMIT = 3.0
"""Time limit in seconds of wall time for the notebook to stop a run."""


class NotebookSubject:
    """A Node class or a function that a notebook's kernel runs."""

    shares_participant = True
    in_a_notebook = True
    is_building = False

    def __init__(self, lines: Lines, *, is_class: bool = False) -> None:
        """Prepare to judge a class or function in a notebook.

        Args:
            lines: The open connection to the notebook.
            is_class: True if the subject is a class. Then :meth:`start` waits until the constructor has returned.
        """
        # The keeper's name is random in each check, so that no student's code can contain it.
        self.keeper = f"_check_keeper_{secrets.token_hex(8)}"
        self._lines = lines
        self._is_class = is_class
        self._recorder: Recorder | None = None
        self._run = 0
        self._fresh = True
        self._marker: str | None = None
        self._may_make_more = False
        self.is_held = False
        self._ended = False
        self._end: Callable[..., None] = lambda *_, **__: None
        self._ready = threading.Event()
        self._stopped = threading.Event()
        self._answered = threading.Event()
        self._seen_as_told = False
        self._news_left = NEWS_LIMIT
        self._gone = threading.Event()
        self._stack, self._used, self.busy = "", 0.0, 0.0
        self._told_stack = threading.Event()
        self._own_lines: list[judge_messages.OwnLine] = []
        self._thread = threading.Thread(target=self._listen, daemon=True)

    def begin(self, domain_id: int) -> None:
        """Have the notebook open a ROS context on the domain."""
        self._thread.start()
        self._tell(judge_messages.Begin(domain_id, self.keeper))
        self._ready.wait(STOP_LIMIT)

    def tell_so_far(self, verdict: Verdict, words: str) -> None:
        """Have the notebook show a card while the check goes on."""
        self._tell(judge_messages.SoFar(verdict, words))

    def renew(self) -> None:
        """Have the notebook open a new ROS context for the next run."""
        self._fresh = True

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Have the notebook wait until its participant sees the endpoints in ``there`` and none in ``gone``."""
        self._answered.clear()
        self._seen_as_told = False
        fresh, self._fresh = self._fresh, False
        asked_at = time.monotonic()
        self._tell(judge_messages.Meet(fresh, sorted(there), sorted(gone), max(0.0, self._news_left)))
        self._answered.wait(max(0.0, self._news_left) + STOP_LIMIT)
        self._news_left -= time.monotonic() - asked_at
        # A notebook that has disconnected cannot answer, so the run begins without an answer. The check then gives no
        # points.
        return self._seen_as_told or self._gone.is_set()

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Have the notebook make the node (if the subject is a class) or call the function."""
        self._run += 1
        self._recorder = recorder
        self._end = recorder.end
        self._marker, self._may_make_more, self._ended = None, False, False
        self.is_held = self._is_class
        self._stopped.clear()
        fresh, self._fresh = self._fresh, False
        self._tell(run_messages.Start(self._run, list(arguments), fresh, options))
        if self._is_class and not recorder.wait(
            lambda: self._marker is not None or self.ended, CONSTRUCT_LIMIT
        ):
            # The constructor may not have returned because it does all of the work itself, for example spins. So go on
            # and judge the subject like a program.
            recorder.record("subject", "never_constructed")

    def interrupt(self) -> None:
        """Have the notebook send Ctrl-C to a program. A class or function in the kernel is not interrupted."""
        self._tell(run_messages.Interrupt(self._run))

    def release(self) -> None:
        """Have the notebook spin the node.

        A node with a timer or thread may make more endpoints once it is spun. So the marker topic, which shows that all
        endpoints exist, is dropped.
        """
        if self._may_make_more:
            self._marker, self._may_make_more = None, False
        self.is_held = False
        self._tell(judge_messages.Release(self._run))

    @property
    def ended(self) -> bool:
        """True if the function has returned or raised, or the notebook has disconnected."""
        return self._ended or self._gone.is_set()

    def processes(self) -> frozenset[int]:
        """Return an empty set: which of the kernel's processes the subject has started is unknown."""
        return frozenset()

    @property
    def marker(self) -> str | None:
        """The topic that the notebook creates after the subject's constructor has returned; None before that."""
        return self._marker or None

    @property
    def may_make_more(self) -> bool:
        """True if the node is not spun yet and has a timer or thread, which may make more endpoints."""
        return self._may_make_more

    def stack(self) -> str:
        """Return the stacks of the subject's threads. The text is empty if the notebook does not answer in time.

        As long as a thread in the student's code uses the processor, ask again, until it has used so much that the code
        must be in a loop. So a loop is told from a program that a busy machine lets wait.
        """
        began, used = time.monotonic(), [0.0]
        while True:
            self._told_stack.clear()
            self._stack, self._used = "", 0.0
            self._tell(judge_messages.Stack(self._run))
            self._told_stack.wait(STOP_LIMIT)
            used.append(self._used)
            self.busy = used[-1] - used[1]
            goes_on = used[-1] > used[-2] and self.busy < LOOPS and not self.ended
            if not goes_on or time.monotonic() - began > LOOP_LIMIT:
                return self._stack
            time.sleep(ASK_AGAIN)

    def own_lines(self) -> list[judge_messages.OwnLine]:
        """Return the lines of the student's code that the notebook sent when the check began."""
        return self._own_lines

    def stop(self) -> None:
        """Have the notebook end the run and destroy its nodes."""
        self._tell(run_messages.Stop(self._run))
        self._stopped.wait(STOP_LIMIT)
        self._recorder = None

    def _tell(self, message: judge_messages.FromJudge) -> None:
        try:
            self._lines.say(message)
        except Hangup:
            self._gone.set()

    def _listen(self) -> None:
        try:
            while True:
                with contextlib.suppress(NotUnderstood):
                    self._take(self._lines.hear(judge_messages.FromNotebook))
        except Hangup as error:
            self._gone.set()
            for event in (self._ready, self._stopped, self._answered):
                event.set()
            if self._recorder is not None:
                self._recorder.record("subject", "gone", why=str(error))

    def _take(self, message: judge_messages.FromNotebook) -> None:
        match message:
            case run_messages.Ready():
                self._ready.set()
            case judge_messages.EndpointsMet(seen=seen):
                self._seen_as_told = seen
                self._answered.set()
            case judge_messages.OwnLines(lines=lines):
                self._own_lines = lines[:MAX_OWN_LINES]
            case judge_messages.Check() | Source() | judge_messages.Sources():
                pass  # the notebook may send these messages only at the beginning, so ignore them now
            case _ if message.run == self._run and self._recorder is not None:
                self._take_of_run(message, self._recorder)

    def _take_of_run(self, message: judge_messages.OfRun, recorder: Recorder) -> None:
        # Each text comes from a process that the student controls, so it is cut to a limit before it is kept.
        record, ended = recorder.record, partial(self._note_end, message.run)
        match message:
            case run_messages.Stopped():
                self._stopped.set()
            case judge_messages.Stacks(text=text, busy=busy):
                self._stack, self._used = text[:MAX_STACK], busy
                self._told_stack.set()
            case run_messages.Output(text=text, logged=logged):
                record("output", "notebook log" if logged else "notebook", text=text[:MAX_TEXT])
            case judge_messages.Started(accepted=names):
                record("subject", "started", accepted=names)
            case judge_messages.Called():
                record("called", "a server")
            case judge_messages.Looked():
                record("looked", "graph")
            case judge_messages.Constructed(marker=marker, goes_on=goes_on, twin=twin):
                self._may_make_more = goes_on
                self._marker = marker[:MAX_MARKER]
                record("subject", "constructed", **({"twin": twin[:MAX_MARKER]} if twin else {}))
            case run_messages.Exited(code=code):
                self._end("exited", ended, code=code)
            case judge_messages.Returned(value=value):
                shown = None if value is None else value[:MAX_TEXT]
                self._end("returned", ended, value=shown, traceback="")
            case judge_messages.Raised(traceback=traceback):
                self._end("raised", ended, value=None, traceback=traceback[:MAX_TEXT])

    def _note_end(self, run: int) -> None:
        if run == self._run:
            self._ended = True


class NotebookPath(InOwnProcesses, NotebookSubject):
    """A workspace or launch file whose programs the notebook's kernel starts."""

    in_a_notebook = True
    is_building = True

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.keeper = InOwnProcesses.keeper

    tell_so_far = NotebookSubject.tell_so_far
    own_lines = NotebookSubject.own_lines

    def _take_of_run(self, message: judge_messages.OfRun, recorder: Recorder) -> None:
        super()._take_of_run(message, recorder)
        match message:
            case run_messages.Output(text=text):
                self.is_building = self.is_building and not tells_of_a_build(text)
