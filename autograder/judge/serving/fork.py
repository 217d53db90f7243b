"""Run a piece of the judge in a child process, so that whatever happens to it the parent can say so."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import time
import traceback
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from autograder.judge.subjects.command_subject import LEFTOVERS
from autograder.judge.verdicts.deciding import SIGNAL
from autograder.process_trees import die_with_parent, end_descendants

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_ENDINGS = (signal.SIGINT, signal.SIGTERM)
LAST_WORDS = 2.0
"""Seconds of wall time that a judge has for its verdict once its time is over."""


@dataclass(frozen=True)
class Outcome:
    """The end of a child.

    Attributes:
        data: What it returned; None where it returned nothing.
        trouble: Why there is no data, in words; empty otherwise.
        hurried: It was killed although its own time was not over.
        unfinished: It was killed, as its time or the shorter one was over.
    """

    data: bytes | None
    trouble: str = ""
    hurried: bool = False
    unfinished: bool = False


class Child:
    """A forked child that computes some bytes. The parent must have no other threads."""

    def __init__(self, work: Callable[[], bytes], limit: float, *, close: Sequence[int] = ()) -> None:
        """Fork and let the child begin.

        Args:
            work: Runs in the child.
            limit: Seconds of wall time after which the child is killed.
            close: File descriptors that the child has no business with.
        """
        sys.stdout.flush()
        sys.stderr.flush()
        self._deadline = time.monotonic() + limit
        self._received = bytearray()
        self.reading, writing = os.pipe()
        parent = os.getpid()
        # What a handler raises within Python's own hooks at a fork is lost, and a Ctrl-C with it.
        # What comes before the child has said what it does with a signal would end it.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {*_ENDINGS, SIGNAL})
        self.pid = os.fork()
        if self.pid == 0:
            signal.signal(SIGNAL, signal.SIG_IGN)
            for ending in _ENDINGS:
                signal.signal(ending, _leave)
            die_with_parent(parent, signal.SIGTERM)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if self.pid == 0:
            for descriptor in close:
                os.close(descriptor)
            _run(work, writing)
        os.close(writing)

    def result(self, *, within: float | None = None) -> Outcome:
        """Wait for the child's bytes, at most until its limit.

        A judge that is deciding then is told to come to an end, and says so: what is in its way is what the
        subject has said. One that is still looking is killed.

        Args:
            within: A shorter limit, in seconds from now.
        """
        hurried = within is not None and time.monotonic() + within < self._deadline
        if within is not None:
            self._deadline = min(self._deadline, time.monotonic() + within)
        asked_to_decide = False
        while True:
            remaining = self._deadline - time.monotonic()
            ready, _, _ = select.select([self.reading], [], [], max(0.0, remaining))
            if not ready and not asked_to_decide:
                asked_to_decide = True
                with contextlib.suppress(ProcessLookupError):
                    os.kill(self.pid, SIGNAL)
                self._deadline = time.monotonic() + LAST_WORDS
                continue
            if not ready:
                self.kill()
                return Outcome(None, "the judge did not finish in time", hurried, unfinished=True)
            chunk = os.read(self.reading, 65536)
            if not chunk:
                break
            self._received += chunk
        os.close(self.reading)
        _, status = os.waitpid(self.pid, 0)
        if os.WIFEXITED(status) and os.WEXITSTATUS(status) == 0 and self._received:
            return Outcome(bytes(self._received))
        how = f"signal {os.WTERMSIG(status)}" if os.WIFSIGNALED(status) else f"code {os.WEXITSTATUS(status)}"
        return Outcome(None, f"the judge's process ended with {how} before it had a verdict")

    def done(self) -> bool:
        """True if the child has ended; frees it then, and kills it once its limit is over."""
        ready, _, _ = select.select([self.reading], [], [], 0.0)
        if ready:
            self.result(within=1.0)
            return True
        if time.monotonic() > self._deadline:
            self.kill()
            return True
        return False

    def kill(self) -> None:
        """End the child at once; its subject dies with it."""
        try:
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
            os.close(self.reading)
        except (ProcessLookupError, ChildProcessError, OSError):
            pass


def _leave(*_: object) -> NoReturn:
    """End at once, with everything that a subject has started: nobody wants a verdict any more."""
    end_descendants(LEFTOVERS)
    os._exit(1)


def _run(work: Callable[[], bytes], writing: int) -> None:
    """The child's whole life. It leaves by os._exit: ROS threads make an orderly exit of the interpreter unsafe."""
    code = 1
    try:
        data = work()
        view = memoryview(data)
        while view:
            view = view[os.write(writing, view) :]
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
