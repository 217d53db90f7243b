"""A node class or a function in a notebook as a subject: the kernel runs it, at the judge's word."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from autograder.judge.link import Link, LinkClosed

if TYPE_CHECKING:
    from autograder.judge.recorder import Recorder

MAX_TEXT = 4_000
"""Characters that are kept of one thing that the notebook says."""
MAX_STACK = 50_000
"""Characters that are kept of a hung subject's stacks."""
CONSTRUCT_LIMIT = 10.0
"""Seconds of wall time in which a node's constructor must have come to its end."""
STOP_LIMIT = 3.0
"""Seconds of wall time in which the notebook must have stopped a run."""


class RemoteSubject:
    """Implements :class:`autograder.judge.subjects.Subject` over a link."""

    shares_participant = True

    def __init__(self, link: Link, *, is_class: bool = False) -> None:
        """Take over a conversation.

        Args:
            link: The notebook's end.
            is_class: The subject is a class, whose constructor must come to its end before anything else.
        """
        self._link = link
        self._is_class = is_class
        self._recorder: Recorder | None = None
        self._run = 0
        self._fresh = True
        self._marker: str | None = None
        self._ended = False
        self._ready = threading.Event()
        self._stopped = threading.Event()
        self._gone = threading.Event()
        self._stack = ""
        self._told_stack = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)

    def begin(self, domain_id: int) -> None:
        """Let the notebook open a ROS context on the domain."""
        self._thread.start()
        self._tell("begin", domain=domain_id)
        self._ready.wait(STOP_LIMIT)

    def renew(self) -> None:
        """Let the next run have a fresh context."""
        self._fresh = True

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Let the notebook make the node (a class) or call the function."""
        self._run += 1
        self._recorder = recorder
        self._marker, self._ended = None, False
        self._stopped.clear()
        fresh, self._fresh = self._fresh, False
        hurry = options.pop("hurry", 1.0)
        self._tell(
            "start", run=self._run, fresh=fresh, arguments=list(arguments), options=options, hurry=hurry
        )
        if self._is_class and not recorder.wait(
            lambda: self._marker is not None or self.ended, CONSTRUCT_LIMIT
        ):
            recorder.record("stack", "subject", text=self.stack())
            recorder.record("subject", "never_constructed")
            self._ended = True

    def release(self) -> None:
        """Let the made node spin."""
        self._tell("release", run=self._run)

    @property
    def ended(self) -> bool:
        """Whether the function has returned or something was raised, or the notebook is gone."""
        return self._ended or self._gone.is_set()

    @property
    def marker(self) -> str | None:
        """The topic that the notebook made after the subject's constructor had ended."""
        return self._marker or None

    def stack(self) -> str:
        """Ask the notebook where the subject's threads are."""
        self._told_stack.clear()
        self._stack = ""
        self._tell("stack", run=self._run)
        self._told_stack.wait(STOP_LIMIT)
        return self._stack

    def stop(self) -> None:
        """Let the notebook end the run and destroy its nodes."""
        self._tell("stop", run=self._run)
        self._stopped.wait(STOP_LIMIT)
        self._recorder = None

    def _tell(self, say: str, **words: Any) -> None:
        try:
            self._link.send(say, **words)
        except LinkClosed:
            self._gone.set()

    def _listen(self) -> None:
        try:
            while True:
                self._take(self._link.receive())
        except LinkClosed:
            self._gone.set()
            self._ready.set()
            self._stopped.set()
            if self._recorder is not None:
                self._recorder.record("subject", "gone")

    def _take(self, message: dict[str, Any]) -> None:
        say, recorder = message["say"], self._recorder
        if say == "ready":
            self._ready.set()
            return
        if message.get("run") != self._run or recorder is None:
            return  # an echo of an earlier run
        if say == "stopped":
            self._stopped.set()
        elif say == "stack":
            self._stack = str(message.get("text") or "")[:MAX_STACK]
            self._told_stack.set()
        elif say == "output":
            recorder.record("output", "notebook", text=_text(message.get("text")))
        elif say == "looked":
            recorder.record("looked", "graph")
        elif say == "constructed":
            self._marker = _text(message.get("marker"))[:200]
            recorder.record("subject", "constructed")
        elif say == "exited":
            self._ended = True
            code = message.get("code")
            recorder.record("subject", "exited", code=code if isinstance(code, int) else None)
        elif say == "callback_raised":
            recorder.record("subject", "callback_raised", traceback=_text(message.get("traceback")))
        elif say in ("returned", "raised"):
            self._ended = True
            value, trace = message.get("value"), _text(message.get("traceback"))
            recorder.record("subject", say, value=None if value is None else _text(value), traceback=trace)


def _text(value: Any) -> str:
    return str(value if value is not None else "")[:MAX_TEXT]
