"""Connects a notebook to the judge, and starts a judge process if no grader has started one.

Notebook and judge share only the definitions of the messages (:mod:`autograder.messages.checks`). The judge imports
nothing from :mod:`autograder.notebook`, and trusts nothing in the kernel, because a student can change all of it.
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
from environment.installation import COMMAND
from environment.python_child import python_child

if TYPE_CHECKING:
    from autograder.messages.lines import Message

MAX_TEXT = 4_000
"""The maximum length in characters of a text that is sent to the judge. A longer message would end the connection."""
START_LIMIT = 60.0
"""Time limit in seconds of wall time for the kernel's own judge to start."""


class JudgeUnreachable(ConnectionError):
    """No judge can be reached."""


class JudgeLink:
    """The connection to the judge for one check. Any thread may send, but only one thread may receive."""

    def __init__(self) -> None:
        """Connect to the judge; start one if there is none.

        Raises:
            JudgeUnreachable: No judge is running, and none could be started.
        """
        path = os.environ.get(SOCKET_VARIABLE) or own_judge().path()
        try:
            self._lines = Lines.to(path)
        except Hangup as error:
            raise JudgeUnreachable(f"the judge cannot be reached ({error})") from error

    def say(self, message: Message) -> None:
        """Send a message. If the judge has ended, do nothing; the next :meth:`hear` raises the error."""
        with contextlib.suppress(Hangup):
            self._lines.say(message)

    def hear(self) -> FromJudge:
        """Return the judge's next message.

        Raises:
            JudgeUnreachable: The judge has ended.
        """
        try:
            message: FromJudge = self._lines.hear(FromJudge)
        except (Hangup, NotUnderstood) as error:
            raise JudgeUnreachable("the judge ended before it reached a verdict") from error
        return message

    def close(self) -> None:
        """Close the connection."""
        self._lines.close()


class OwnJudge:
    """The judge process of this kernel. It ends together with the kernel, because then its standard input is closed."""

    def __init__(self) -> None:
        self._folder = HeldFolder("autograder-judge-")
        self._socket = self._folder.path / f"{secrets.token_hex(8)}.socket"
        environment = {k: v for k, v in os.environ.items() if not k.startswith("RCUTILS_LOGGING")}
        judge = python_child("-m", "autograder.judge", "--socket", str(self._socket), environment=environment)
        self._process = judge.start(
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # a new session, because an interrupt of the kernel must not reach the judge
            start_new_session=True,
        )
        self._pid = os.getpid()
        self._ready = False

    def path(self) -> str:
        """Return the path of the judge's socket once it listens.

        Raises:
            JudgeUnreachable: The judge did not start.
        """
        if not self._ready:
            assert self._process.stdout is not None
            self._ready = self._process.stdout.readline() == b"ready\n"
        if not self._ready or not self.alive:
            raise JudgeUnreachable(
                f"the judge did not start; `{COMMAND} doctor` in a terminal says what is missing"
            )
        return str(self._socket)

    @property
    def alive(self) -> bool:
        """True if the judge runs and was started by this process, not by a process from which this one was forked."""
        return self._pid == os.getpid() and self._process.poll() is None

    def stop(self) -> None:
        """End the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._folder.remove()


_own: OwnJudge | None = None


def own_judge() -> OwnJudge:
    """Return this kernel's own judge. The first call starts it; a later call restarts a judge that has died."""
    global _own
    if _own is None or not _own.alive:
        _own = OwnJudge()
        atexit.register(_own.stop)
    return _own


def warm_up() -> None:
    """Start this kernel's judge before the first check needs it. If a grader has started a judge, do nothing."""
    if not os.environ.get(SOCKET_VARIABLE):
        own_judge()
