"""Runs a check in a child process with time limits, so that the parent can report a crash or a hang of the child.

The parent limits the wall time of the whole check. The child limits the processor time in which it computes the
verdict, because some output of a student's program would keep a criterion busy almost forever. This limit is in
processor time, so that it has the same effect on a busy machine as on an idle one.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
import time
import traceback
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NoReturn

from autograder.judge.subject import LEFTOVERS
from autograder.process_trees import die_with_parent, end_descendants
from autograder.verdict import Diagnosis, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.kit.model import Exercise
    from autograder.verdict import Verdict


_ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM)
LAST_WORDS = 2.0
"""Seconds of wall time that a judge gets for its verdict after the time limit of the check, before it is killed."""


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
    """A forked child process that computes some bytes. Create it only while this process has a single thread."""

    def __init__(self, work: Callable[[], bytes], limit: float, *, close: Sequence[int] = ()) -> None:
        """Fork and start the child.

        Args:
            work: Computes the bytes, in the child.
            limit: Seconds of wall time after which the child is killed.
            close: File descriptors that the child must not keep.
        """
        sys.stdout.flush()
        sys.stderr.flush()
        self._deadline = time.monotonic() + limit
        self._received = bytearray()
        self.reading, writing = os.pipe()
        parent = os.getpid()
        # Block signals while forking, for two reasons. If a signal handler raises an exception inside a fork hook,
        # Python drops the exception, so a Ctrl-C would be lost. And a signal that arrives before the child has set its
        # handlers would kill the child.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {*_ENDING_SIGNALS, STOP_SIGNAL})
        self.pid = os.fork()
        if self.pid == 0:
            signal.signal(STOP_SIGNAL, signal.SIG_IGN)
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
        """Wait for the child's result, at most until the child's time limit.

        At the limit, a child that is computing the verdict is told to stop. It then returns a verdict which says that
        the subject's output is too long to judge. A child that is still observing the subject is killed.

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
                    os.kill(self.pid, STOP_SIGNAL)
                self._deadline = time.monotonic() + LAST_WORDS
                continue
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
        if time.monotonic() > self._deadline:
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


VERDICT_LIMIT = 10.0
"""The limit in seconds of processor time for one verdict, which usually takes a hundredth of a second."""
SIGNAL_AGAIN_AFTER = 0.05
"""The seconds of processor time after which the signal is sent again if the verdict is still not ready.

The signal's exception may be lost, because Python prints and drops an exception that is raised in a destructor or in a
callback of the garbage collector.
"""
SURE = 1.0
"""If a verdict has taken this many seconds of processor time, the cause is the subject's output, not a busy machine."""
STOP_SIGNAL = signal.SIGVTALRM
"""The signal that stops the computation of a verdict. At other times the judge ignores this signal."""


class Undecided(BaseException):
    """The judge did not reach a verdict in time.

    This is a BaseException, so that ``except Exception`` does not catch it.
    """


@contextlib.contextmanager
def limited(seconds: float = VERDICT_LIMIT) -> Iterator[None]:
    """Run the block within a limit of processor time.

    Args:
        seconds: Limit in seconds of processor time.

    Raises:
        Undecided: The time is over, or the parent process has sent ``STOP_SIGNAL`` after the block used at least
            :data:`SURE` seconds of processor time: the subject's output is the cause, and the verdict says so. An
            earlier signal is ignored here: the machine is the cause, and the parent process ends the check without a
            verdict.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread can handle signals, so elsewhere there is no limit
        return

    began = time.process_time()

    def give_up(*_: object) -> None:
        if time.process_time() - began >= min(seconds, SURE):
            raise Undecided

    before = signal.signal(STOP_SIGNAL, give_up)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds, SIGNAL_AGAIN_AFTER)
    try:
        yield
    finally:
        _switch_limit_off(before)


def _switch_limit_off(before: signal.Handlers | Callable[..., object] | int | None) -> None:
    """Switch the limit off, even if the signal arrives again meanwhile."""
    while True:
        try:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
            signal.signal(STOP_SIGNAL, before)
            return
        except Undecided:
            continue


def undecidable(exercise: Exercise, seed: str) -> Verdict:
    """Return a verdict of zero points, which says that the subject's output is too long to judge."""
    diagnosis = Diagnosis(
        "undecidable",
        "Your program said and sent far too much: the judge could not finish reading it.",
        "Log what the task asks for, one short line for each thing that happens, and nothing else.",
    )
    return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)
