"""The notebook's end of the conversation with the judge, and the judge process where nobody has given one.

What both say is in :mod:`autograder.messages.checks`. It shares no more code with the judge, on purpose: what runs here
is in the student's hands.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import secrets
import subprocess
from typing import TYPE_CHECKING

from autograder.messages.checks import SOCKET_VARIABLE, FromJudge
from autograder.messages.lines import Hangup, Lines, NotUnderstood
from autograder.temporary_folders import HeldFolder
from environment.python_child import python_child

if TYPE_CHECKING:
    from autograder.messages.lines import Message

MAX_TEXT = 4_000
"""Characters of one text of the subject's that the judge looks at; more at once would end the conversation."""
START_LIMIT = 60.0
"""Seconds of wall time in which a judge of one's own must be up."""


class JudgeUnreachable(ConnectionError):
    """There is no judge to ask."""


class JudgeLink:
    """One check's conversation. Sending is safe from any thread; receiving is for one."""

    def __init__(self) -> None:
        """Connect to the judge, starting one where that is needed.

        Raises:
            JudgeUnreachable: There is none and none could be started.
        """
        path = os.environ.get(SOCKET_VARIABLE) or own_judge().path()
        try:
            self._lines = Lines.to(path)
        except Hangup as error:
            raise JudgeUnreachable(f"the judge cannot be reached ({error})") from error

    def say(self, message: Message) -> None:
        """Say one thing; nothing happens when the judge is gone, which :meth:`hear` tells."""
        with contextlib.suppress(Hangup):
            self._lines.say(message)

    def hear(self) -> FromJudge:
        """The judge's next message.

        Raises:
            JudgeUnreachable: The judge is gone.
        """
        try:
            message: FromJudge = self._lines.hear(FromJudge)
        except (Hangup, NotUnderstood) as error:
            raise JudgeUnreachable("the judge ended before it had a verdict") from error
        return message

    def close(self) -> None:
        """Hang up."""
        self._lines.close()


class OwnJudge:
    """The judge process of this kernel; it ends with the kernel, which holds its standard input."""

    def __init__(self) -> None:
        self._folder = HeldFolder("autograder-judge-")
        self._socket = self._folder.path / f"{secrets.token_hex(8)}.socket"
        environment = {k: v for k, v in os.environ.items() if not k.startswith("RCUTILS_LOGGING")}
        judge = python_child("-m", "autograder.judge", "--socket", str(self._socket), environment=environment)
        self._process = judge.start(
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # Interrupting the kernel must not end the judge.
            start_new_session=True,
        )
        self._pid = os.getpid()
        self._ready = False

    def path(self) -> str:
        """Its socket, once it listens.

        Raises:
            JudgeUnreachable: It did not start.
        """
        if not self._ready:
            assert self._process.stdout is not None
            self._ready = self._process.stdout.readline() == b"ready\n"
        if not self._ready or not self.alive:
            raise JudgeUnreachable(
                "the judge did not start; `./course doctor` in a terminal says what is missing"
            )
        return str(self._socket)

    @property
    def alive(self) -> bool:
        """True if the process runs and is this kernel's, not one inherited by a fork."""
        return self._pid == os.getpid() and self._process.poll() is None

    def stop(self) -> None:
        """End it."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._folder.remove()


_own: OwnJudge | None = None


def own_judge() -> OwnJudge:
    """This kernel's own judge; started at the first call, and again where it has died."""
    global _own
    if _own is None or not _own.alive:
        _own = OwnJudge()
        atexit.register(_own.stop)
    return _own


def warm_up() -> None:
    """Start the judge before the first check needs it, unless a grader has one ready."""
    if not os.environ.get(SOCKET_VARIABLE):
        own_judge()
