"""Watch mode: checks a class or function again each time a cell redefines it.

Watching begins after a check that did not earn all points, or when a student calls ``watch``.

The check runs while the kernel is idle, so no cell takes longer. A check cannot run at the same time as a cell, because
it replaces rclpy's default context and captures all output. So when a cell is run, the check stops, and starts again
after the cell. A restart of the kernel ends watching. While a grader executes a notebook, nothing is watched.
"""

from __future__ import annotations

import atexit
import contextvars
import inspect
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from autograder.cards import html_rendering
from autograder.notebook.cell_output import notebook_shell
from autograder.notebook.checking.card_display import (
    Progress,
    ProgressUpdater,
    display_card,
    is_live,
    renew_card,
    update_card,
)
from autograder.notebook.checking.check import after_each_check, converse, recorded, what_to_pass
from autograder.notebook.checking.judge_link import JudgeLink, JudgeUnreachable
from autograder.verdict import State, not_checked

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.verdict import Verdict


@dataclass
class WatchedExercise:
    """An exercise that is watched. ``watch`` returns this object.

    Attributes:
        exercise: The exercise's id.
        name: The name of the watched class or function.
        subject: The newest class or function with that name.
        due: True if this subject still has to be checked.
        progress: The progress of the running check.
    """

    exercise: str
    name: str
    subject: Any
    due: bool = False
    progress: Progress = field(default_factory=Progress)
    _verdict: Verdict | None = None
    _handle: Any = None
    _here: contextvars.Context = field(default_factory=contextvars.copy_context)

    def begin(self, subject: Any) -> None:
        """Show a card below the cell that has just defined this subject, and plan the check."""
        if self._handle is not None:
            # Mark the earlier card as out of date. If the same cell was run again, this card has already disappeared.
            self.say(f"Another cell has defined {self.name} since then.", over=True)
        self.subject, self.due = subject, True
        # The context variables tell which cell is running, so that output can be assigned to that cell.
        self._here = contextvars.copy_context()
        self._handle = display_card(self._card("The check begins as soon as this cell has ended."))

    def tell(self) -> None:
        """Update the progress on the card."""
        self.say(self.progress.words())

    def show(self, verdict: Verdict) -> None:
        """Show the verdict on this card and on the card of the check cell."""
        self.settle(verdict)
        self._here.run(self._record, verdict)

    def _record(self, verdict: Verdict) -> None:
        with recorded(verdict, self.subject):
            renew_card(verdict, self.subject)

    def settle(self, verdict: Verdict) -> None:
        """Show the verdict on this card, and record that the subject has been checked."""
        before = self._verdict.score if self._verdict else None
        self._verdict, self.due = verdict, False
        self._here.run(
            update_card, self._handle, html_rendering.card_bundle(verdict, before=before, short=True)
        )

    def say(self, words: str, *, over: bool = False) -> None:
        """Show these words on the card. ``over`` means that no result follows."""
        # Run in a copy of the context, because the thread that shows the progress may be using the context itself.
        self._here.copy().run(update_card, self._handle, self._card(words, over=over))

    def _card(self, words: str, *, over: bool = False) -> dict[str, str]:
        return html_rendering.waiting_bundle(f"{self.exercise}, {self.name}", words, over=over)

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        if _watches is None or _watches.all.get(self.exercise) is not self:
            return f"{self.name} is not watched."
        return f"{self.name} is checked again whenever its cell is run. unwatch() ends it."


class _Watches:
    """All exercises that are watched in this kernel.

    Args:
        shell: IPython's shell.
    """

    def __init__(self, shell: Any) -> None:
        self.all: dict[str, WatchedExercise] = {}
        self._names: dict[str, Any] = shell.user_ns
        self._thread: threading.Thread | None = None
        self._link: JudgeLink | None = None
        self._giving_way = False
        self._lock = threading.Lock()
        # Use these two events and not pre_run_cell and post_run_cell, because a front end's silent executions trigger
        # only these, and post_execute comes before post_run_cell.
        shell.events.register("pre_execute", self._give_way)
        shell.events.register("post_execute", self._go_on)
        atexit.register(self._give_way)  # stop the check before ROS is shut down

    def _go_on(self) -> None:
        """Check what the cell has redefined, and restart a check that waited for the end of the cell.

        IPython calls this after each cell.
        """
        for watch in self.all.values():
            subject = self._names.get(watch.name)
            if _is_code(subject) and subject is not watch.subject:
                watch.begin(subject)
        if any(watch.due for watch in self.all.values()):
            self._giving_way = False
            self._thread = threading.Thread(target=self._check_what_is_due, name="watched cells", daemon=True)
            self._thread.start()

    def _give_way(self) -> None:
        """Stop the running check. It starts again after the cell. IPython calls this before each cell."""
        if self._thread is None:
            return
        with self._lock:
            self._giving_way = True
            if self._link is not None:
                self._link.close()
        self._thread.join()
        self._thread = None

    def _check_what_is_due(self) -> None:
        for watch in list(self.all.values()):
            if watch.due:
                watch.progress = Progress(on_step=watch.tell)
                watch.tell()
                self._check(watch)

    def _check(self, watch: WatchedExercise) -> None:
        try:
            link = JudgeLink()
            with self._lock:
                self._link = link
                if self._giving_way:
                    link.close()
            updater = ProgressUpdater(watch.tell)
            try:
                verdict = converse(link, watch.exercise, watch.subject, watch.progress)
            finally:
                updater.stop()
                link.close()
        except JudgeUnreachable as error:
            if self._giving_way:
                watch.say("The check begins again as soon as the running cell has ended.")
                return
            verdict = not_checked(watch.exercise, watch.exercise, 0.0, str(error), "Run the cell again.")
        if verdict is not None:  # a grader's judge sends the notebook no verdict
            watch.show(verdict)


_watches: _Watches | None = None
_ended_by_the_student = False


def watch(exercise: str, subject: Callable[..., Any]) -> WatchedExercise:
    """Check a class again whenever its cell is run, until ``unwatch()`` or a restart of the kernel.

    A short card below the cell shows the points, what happened and what to do next. These checks change no grade. While
    a grader or nbgrader's Validate runs the notebook, nothing is watched.

    Args:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        subject: The class or function, as in the check cell.

    Raises:
        TypeError: The subject is neither a class nor a function. The message says what to write instead.
    """
    global _watches, _ended_by_the_student
    if not _is_code(subject):
        raise TypeError(what_to_pass(exercise, subject, "watch"))
    _ended_by_the_student = False
    begun = WatchedExercise(exercise, subject.__name__, subject)
    if is_live():
        _watches = _watches or _Watches(notebook_shell())
        # If the student calls watch(...) in the cell of the class, the call is repeated with each run of the cell.
        # Then return the object of the earlier call, so that the new class counts as not checked yet.
        earlier = _watches.all.get(exercise)
        if earlier is not None and earlier.name == begun.name:
            return earlier
        _watches.all[exercise] = begun
    return begun


def unwatch() -> None:
    """Stop watching everything, also after failed checks, until ``watch`` is called. The cards stay."""
    global _ended_by_the_student
    _ended_by_the_student = True
    if _watches is not None:
        _watches.all.clear()


def switch(exercise: str, subject: Callable[..., Any]) -> str:
    """Watch a class or function or, if it is watched, stop watching. The button *Watch* calls this.

    Args:
        exercise: The exercise's id.
        subject: The class or function.

    Returns:
        A sentence that says what is watched from now on.
    """
    if _watches is not None and exercise in _watches.all:
        unwatch()
        return f"{subject.__name__} is no longer checked automatically."
    return repr(watch(exercise, subject))


def watch_after(verdict: Verdict, subject: Any) -> None:
    """Watch a subject that a student has checked, if it did not pass. It is checked again when it is redefined.

    After ``unwatch()`` this does nothing, until the student calls ``watch``.
    """
    watched = _watches.all.get(verdict.exercise) if _watches is not None else None
    if watched is not None and watched.due and watched.subject is subject:
        watched.settle(verdict)
    is_failed_code = verdict.state is State.FAILED and _is_code(subject)
    if is_failed_code and is_live() and not _ended_by_the_student:
        watch(verdict.exercise, subject)


def _is_code(subject: object) -> bool:
    return inspect.isclass(subject) or inspect.isfunction(subject)


after_each_check(watch_after)
