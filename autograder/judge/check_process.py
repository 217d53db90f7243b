"""Runs a check in a child process with a time limit, so that the parent can report a crash or a hang of the child.

At the limit there is no verdict, so no limit in seconds decides about points.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import time
import traceback
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from autograder.judge.subject import LEFTOVERS
from autograder.process_trees import die_with_parent, end_descendants

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


_ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True)
class ChildResult:
    """The result of a child process, or the reason why there is none.

    Attributes:
        data: The bytes that the child sent to its parent; None if it sent nothing.
        trouble: Why there is no data, as a text for people; empty if there is data.
        hurried: True if the child was killed at a shorter limit than its own (``within`` of :meth:`Child.result`).
        unfinished: True if the child was killed at any time limit.
    """

    data: bytes | None
    trouble: str = ""
    hurried: bool = False
    unfinished: bool = False


class Child:
    """A forked child process that computes some bytes. Create it only while this process has a single thread.

    Attributes:
        pid: The id of the process.
        reading: The file descriptor that becomes readable when the child sends something or ends.
        deadline: When the child is killed, on the clock of ``time.monotonic``.
    """

    def __init__(self, work: Callable[[], bytes], limit: float, *, close: Sequence[int] = ()) -> None:
        """Fork and start the child.

        Args:
            work: Computes the bytes, in the child.
            limit: Seconds of wall time after which the child is killed.
            close: File descriptors that the child must not keep.
        """
        sys.stdout.flush()
        sys.stderr.flush()
        self.deadline = time.monotonic() + limit
        self._received = bytearray()
        self.reading, writing = os.pipe()
        parent = os.getpid()
        # Block signals while forking, for two reasons. If a signal handler raises an exception inside a fork hook,
        # Python drops the exception, so a Ctrl-C would be lost. And a signal that arrives before the child has set its
        # handlers would kill the child.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING_SIGNALS)
        self.pid = os.fork()
        if self.pid == 0:
            for ending in _ENDING_SIGNALS:
                signal.signal(ending, _leave_without_result)
            die_with_parent(parent, signal.SIGTERM)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if self.pid == 0:
            for descriptor in close:
                os.close(descriptor)
            _run_in_child(work, writing)
        os.close(writing)

    def result(self, *, within: float | None = None) -> ChildResult:
        """Wait for the child's result, at most until the child's time limit. At the limit, the child is killed.

        Args:
            within: A shorter limit, in seconds from now.
        """
        hurried = within is not None and time.monotonic() + within < self.deadline
        # A caller in a hurry may shorten the limit, but must not give the child more time.
        if within is not None:
            self.deadline = min(self.deadline, time.monotonic() + within)
        while True:
            remaining = self.deadline - time.monotonic()
            ready, _, _ = select.select([self.reading], [], [], max(0.0, remaining))
            if not ready:
                self.kill()
                return ChildResult(None, "the judge did not finish in time", hurried, unfinished=True)
            chunk = os.read(self.reading, 65536)
            if not chunk:
                break
            self._received += chunk
        os.close(self.reading)
        _, status = os.waitpid(self.pid, 0)
        if os.WIFEXITED(status) and os.WEXITSTATUS(status) == 0 and self._received:
            return ChildResult(bytes(self._received))
        how = f"signal {os.WTERMSIG(status)}" if os.WIFSIGNALED(status) else f"code {os.WEXITSTATUS(status)}"
        return ChildResult(None, f"the judge's process ended with {how} before it reached a verdict")

    def done(self) -> bool:
        """Return True if the child has ended. If its time limit is over, kill it first."""
        ready, _, _ = select.select([self.reading], [], [], 0.0)
        if ready:
            self.result(within=1.0)
            return True
        if time.monotonic() > self.deadline:
            self.kill()
            return True
        return False

    def kill(self) -> None:
        """Kill the child at once. The subject's processes end together with the child."""
        try:
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
            os.close(self.reading)
        except (ProcessLookupError, ChildProcessError, OSError):
            pass


def _leave_without_result(*_: object) -> NoReturn:
    """End everything that the subject has started, then exit without a verdict."""
    end_descendants(LEFTOVERS)
    os._exit(1)


def _run_in_child(work: Callable[[], bytes], writing: int) -> None:
    """Send the result of ``work`` to the parent, then call os._exit: with ROS threads, a normal exit is unsafe."""
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
