"""Displays a check's result as a card below the cell.

Repeated checks of a cell use the same place below the cell. At first, the card of the previous check stays, so that the
page does not jump. If the new check takes long, the card shows its progress instead, so that the student does not take
the old diagnosis for the new one. If the checked class or function is redefined, the card is dimmed and says so.
"""

from __future__ import annotations

import contextvars
import inspect
import json
import os
import sys
import threading
import time
import weakref
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

from autograder import check_journal, course, packed_files
from autograder.cards import html_rendering
from autograder.cards.card_content import Solution
from autograder.cards.card_wording import duration
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.notebook.cell_output import notebook_shell
from autograder.notebook.checking.nbgrader_validation import is_validating
from autograder.notebook.checking.subject_runs import own_text

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from autograder.verdict import Verdict


SOON = 0.4
"""Seconds of wall time after which a running check shows its progress; also the time between two updates."""
LONG = 30.0
"""Seconds of wall time after which a running check also shows what the judge knows so far, and whether the machine is
busy.
"""
CROWDED = 4.0
"""The number of runnable processes per processor, over the last minute, above which a machine counts as busy."""


@dataclass
class Progress:
    """The progress of a check.

    Attributes:
        step: The current step, such as ``"run 2"``.
        known: What the judge knows so far, in a sentence.
        verdict: The criteria that are decided so far; None as long as the judge has not told any.
        began: The time at which the check began, in seconds of a monotonic clock.
        is_interrupted: True if the student has interrupted the check.
        on_step: Called after each change of the step.
        on_news: Called as soon as the card should show a newer verdict.
    """

    step: str = "the judge gets ready"
    known: str = ""
    verdict: Verdict | None = None
    began: float = field(default_factory=time.monotonic)
    is_interrupted: bool = False
    on_step: Callable[[], None] = lambda: None
    on_news: Callable[[], None] = lambda: None

    def take(self, verdict: Verdict, known: str) -> None:
        """Take what the judge knows so far. Once it has watched a run to its end, the card shows it at once."""
        is_news = self.verdict is not None
        self.verdict, self.known = verdict, known
        if is_news:
            self.on_news()

    def doing(self, step: str) -> None:
        """Change the current step."""
        self.step = step
        self.on_step()

    def interrupt(self) -> None:
        """Say from now on that the check was interrupted, because it may take seconds to stop the student's code."""
        self.is_interrupted = True
        self.on_news()

    def words(self) -> str:
        """Return the progress in a sentence. If the check has already taken long, a second one says what is known."""
        if self.is_interrupted:
            return "The check was interrupted. It ends as soon as your code has been stopped."
        seconds = time.monotonic() - self.began
        words = f"Checking: {self.step}, {duration(seconds)} …"
        if seconds < LONG:
            return words
        busy = os.getloadavg()[0] > CROWDED * (os.cpu_count() or 1)
        slow = (
            "The machine is busy: other programs want its processors, so this takes longer." if busy else ""
        )
        return " ".join(filter(None, (words, slow, self.known)))


class ProgressUpdater:
    """Updates the progress of a check repeatedly, in its own thread, until :meth:`stop`.

    Args:
        tell: A function that shows the progress on the card.
    """

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell, self._news, self._is_over = tell, threading.Event(), False
        here = contextvars.copy_context()  # tells ipykernel to which cell the output belongs
        self._thread = threading.Thread(target=here.run, args=(self._repeat,), name="check", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop updating. After this call the card is not changed any more."""
        self._is_over = True
        self.tell_now()
        self._thread.join()

    def tell_now(self) -> None:
        """Update the card now, not only after a while."""
        self._news.set()

    def _repeat(self) -> None:
        while True:
            self._news.wait(SOON)
            self._news.clear()
            if self._is_over:
                return
            self._tell()


@dataclass
class _Shown:
    """A card that is on the page, with its verdict and its subject."""

    verdict: Verdict
    before: float | None
    handle: Any
    name: str
    subject: Any
    """A weak reference to the checked class or function; None for a path."""
    dated: bool = False


_shown: dict[str, _Shown] = {}
_watching: list[Any] = []


@dataclass
class CardDisplay:
    """Displays the card of one check. Enter this context before the check begins, in the same thread.

    Attributes:
        exercise: The exercise's id.
        subject: The checked class, function or path.
        progress: The progress, which the card shows until the result is there.
    """

    exercise: str
    subject: Any
    progress: Progress = field(default_factory=Progress)
    _handle: Any = None
    _updater: ProgressUpdater | None = None

    def __enter__(self) -> Self:
        if is_live():
            earlier = _shown.get(self.exercise)
            if earlier is not None:
                self._handle = display_card(
                    _dated(earlier, "Checking again: this is the result of the previous check.")
                )
            self._updater = ProgressUpdater(self._tell)
            self.progress.on_news = self._updater.tell_now
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._stop_updating()
        finally:  # also after another interrupt, or the card would say for ever that the check goes on
            if error is not None and self._handle is not None:
                self._say_interrupted()

    def _say_interrupted(self) -> None:
        earlier = _shown.get(self.exercise)
        if earlier is not None:
            notice = "This is the result of an earlier check: the last one was interrupted."
            card = _dated(earlier, notice)
        else:
            words = "The check was interrupted, so there is no result: run it again."
            card = html_rendering.waiting_bundle(self.exercise, words, over=True)
        update_card(self._handle, card)

    def show(self, verdict: Verdict) -> None:
        """Show the result on the card; outside a notebook, print it."""
        self._stop_updating()
        shell = notebook_shell()
        earlier = _shown.get(self.exercise)
        before = earlier.verdict.score if earlier else None
        card = _full_card(verdict, before, self.subject)
        if shell is None:
            print(card["text/plain"])
        elif self._handle is not None:
            update_card(self._handle, card)
        else:
            self._handle = display_card(card)
        if shell is not None:
            _remember(shell, self.exercise, self.subject, _Shown(verdict, before, self._handle, "", None))

    def _stop_updating(self) -> None:
        if self._updater is not None:
            self._updater.stop()

    def _tell(self) -> None:
        words, so_far, earlier = self.progress.words(), self.progress.verdict, _shown.get(self.exercise)
        title = earlier.verdict.title if earlier is not None else self.exercise
        card = (
            html_rendering.card_bundle(so_far, notice=words)
            if so_far is not None
            else html_rendering.waiting_bundle(title, words)
        )
        if self._handle is None:
            self._handle = display_card(card)
        else:
            update_card(self._handle, card)


def _dated(shown: _Shown, notice: str) -> dict[str, str]:
    """Return the HTML and text of a shown card, with a notice that the card is out of date."""
    return _full_card(shown.verdict, shown.before, notice=notice)


def renew_card(verdict: Verdict, subject: Any) -> None:
    """Show a newer verdict on the exercise's card, if the page has such a card."""
    shell, earlier = notebook_shell(), _shown.get(verdict.exercise)
    if shell is not None and earlier is not None:
        before = earlier.verdict.score
        update_card(earlier.handle, _full_card(verdict, before, subject))
        _remember(shell, verdict.exercise, subject, _Shown(verdict, before, earlier.handle, "", None))


def _full_card(
    verdict: Verdict, before: float | None, subject: Any = None, notice: str = ""
) -> dict[str, str]:
    # Show no solution in a grader's kernel, because the solution would then be in the graded notebook.
    solution = solution_of(verdict.exercise) if is_live() else None
    if solution is not None and subject is not None:
        solution = replace(solution, own=tuple(own_text(broken, subject) for broken in solution.broken))
    journal = check_journal.entries(check_journal.session_journal_path()) if solution else []
    is_shown = verdict.passed or check_journal.has_opened_solution(verdict.exercise, journal)
    # Until the pass of a bug hunt, nothing tells the cause.
    is_offered = not (is_shown or (solution and solution.broken))
    return html_rendering.card_bundle(
        verdict,
        before=before,
        notice=notice,
        solution=solution if is_shown else None,
        offers_solution=is_offered and check_journal.may_open_solution(verdict.exercise, journal),
    )


def open_solution(exercise: str) -> str:
    """Show the worked solution on the exercise's card, and record this in the journal. The card's button calls this.

    Args:
        exercise: The exercise's id.

    Returns:
        A sentence for the student.
    """
    shown = _shown.get(exercise)
    journal = check_journal.entries(check_journal.session_journal_path())
    if shown is None or not check_journal.may_open_solution(exercise, journal):
        return "Run the check again first: this card is from an earlier session, or from before a reset."
    if not check_journal.note_solution(exercise):
        return "The worked solution stays closed, because your progress cannot be written: is the disk full?"
    update_card(shown.handle, _full_card(shown.verdict, shown.before))
    return "The worked solution is at the end of the card. If you do not see it there, check again."


def is_live() -> bool:
    """Return True if a student may see the output: the kernel is neither a grader's nor that of nbgrader's Validate."""
    return notebook_shell() is not None and not os.environ.get(SOCKET_VARIABLE) and not is_validating()


def _remember(shell: Any, exercise: str, subject: Any, shown: _Shown) -> None:
    if inspect.isclass(subject) or inspect.isfunction(subject):
        shown.name, shown.subject = subject.__name__, weakref.ref(subject)
    _shown[exercise] = shown
    if not _watching and is_live():
        _watching.append(shell)
        shell.events.register("post_run_cell", _dim_what_is_out_of_date)


def _dim_what_is_out_of_date(_: Any = None) -> None:
    """Dim the cards whose class or function has been redefined since the check. IPython calls this after each cell."""
    names = getattr(_watching[0], "user_ns", {})
    for shown in _shown.values():
        if shown.dated or not shown.name or shown.name not in names:
            continue
        if names[shown.name] is not shown.subject():
            shown.dated = True
            notice = f"{shown.name} has changed since this check: run the check again."
            update_card(shown.handle, _dated(shown, notice))


def display_card(card: dict[str, str]) -> Any:
    """Show a card below the running cell, and return the handle to update it."""
    from IPython.display import display

    return display(card, raw=True, display_id=True)  # type: ignore[no-untyped-call]


def update_card(handle: Any, card: dict[str, str]) -> None:
    """Replace the content of a card that is already on the page."""
    # A kernel that is shutting down has closed its streams.
    if not sys.is_finalizing():
        handle.update(card, raw=True)


def solution_of(exercise: str) -> Solution | None:
    """Return the reference solution; None if there is none, as in a hand-out and in a grader's sandbox.

    Args:
        exercise: The exercise's id.
    """
    try:
        for chapter in course.chapters(course.root()):
            for lab in chapter.labs:
                if file := chapter.exercises_of(lab).get(exercise):
                    said = json.loads(packed_files.read(file.with_suffix(course.SOLUTION)))
                    fields = {name: said[name] for name in ("why", "other_way", "other_code") if name in said}
                    return Solution(tuple(said["code"]), broken=tuple(said.get("broken", ())), **fields)
    except (OSError, EOFError, ValueError, KeyError, TypeError, course.NoCourse, course.BrokenChapter):
        pass  # The solution is only an addition, so an error here must not break the check.
    return None
