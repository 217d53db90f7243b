"""The trace of a check in a student's own notebook: a line in their journal, and a card at the chapter's end."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from autograder import course, journal
from autograder.notebook.cells.student_tracebacks import notebook_shell
from autograder.notebook.checking.card_display import is_live
from autograder.notebook.checking.judge_link import SOCKET_VARIABLE

if TYPE_CHECKING:
    from autograder.verdict import Verdict


def keep(verdict: Verdict) -> None:
    """Note a check in the journal; where it was the last one of a chapter, show the certificate.

    A grader's kernel has no journal. Nothing here can break a check: what cannot be read or written is left out.
    """
    if notebook_shell() is None or os.environ.get(SOCKET_VARIABLE):
        return
    try:
        ended = _chapter_ended_by(verdict)
    except (OSError, course.NoCourse, course.BrokenChapter):
        ended = None
    if ended is not None and is_live():
        _show(*ended)


def _chapter_ended_by(verdict: Verdict) -> tuple[str, float, float] | None:
    """Title, points and time of the chapter that had all its points with this check and not before."""
    place = journal.own_place()
    before = journal.best(journal.entries(place))
    journal.note_check(verdict, place)
    if place is None or not verdict.passed:
        return None
    after = journal.best(journal.entries(place))
    for chapter in course.chapters(course.root()):
        finished = journal.finished(chapter, after)
        if finished is not None and journal.finished(chapter, before) is None:
            wanted = [name for lab in chapter.labs for name in chapter.exercises_of(lab)]
            return chapter.title, sum(after[name].possible for name in wanted), finished
    return None


def _show(title: str, points: float, finished: float) -> None:
    from IPython.display import display

    from autograder.cards import certificate

    display(certificate.mimebundle(title, points, finished), raw=True)  # type: ignore[no-untyped-call]
