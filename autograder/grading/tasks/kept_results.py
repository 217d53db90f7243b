"""Stores the results of a run, and decides which result of a notebook counts: the new one, or an earlier one."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading.tasks.fallen_points import FallenPoints, fallen, fits

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.grading.class_records import Attempt
    from autograder.grading.class_store import ClassStore
    from autograder.grading.table.rows import Row
    from autograder.grading.tasks.asked_for import AskedFor
    from autograder.grading.tasks.submission_work import Result, Work


class KeptResults:
    """The results of a run.

    Args:
        store: The store of the class.
        fallen: The results that wait for the instructor.
        asked: The choices of the instructor.

    Attributes:
        fallen: The results that wait for the instructor.
        run_again: The number of notebooks that were executed, by the reason; empty for the first time.
    """

    def __init__(self, store: ClassStore, fallen: FallenPoints, asked: AskedFor) -> None:
        self._store, self._asked = store, asked
        self.fallen = fallen
        self.run_again: Counter[str] = Counter()
        self._earlier: dict[tuple[str, str], Attempt] = {}

    def expect(self, works: Iterable[Work]) -> None:
        """Remember the newest attempt of each submission that is going to be graded."""
        self._earlier = {
            (work.student, attempt.assignment): attempt  # the newest one, which comes last
            for work in works
            for attempt in self._store.attempts(work.student)
        }
        if self._asked.lower == "no":
            self.fallen.forget(self._asked.has)

    def keep(self, result: Result) -> Result:
        """Store the result of an executed notebook. Return it, or the earlier one if the points of the same files fell.

        The result that is returned is without its evidence.
        """
        work, task, execution = result.work, result.task, result.execution
        why, last = self._why_again(work), self._earlier.get(work.key)
        self.run_again[why] += 1
        earlier = last if last and last.made_from.handed_in == work.made_from.handed_in else None
        found = fallen(task, execution, earlier, why) if self._asked.lower != "yes" else []
        if found and self._asked.dry_run:
            return replace(result, execution=replace(execution, evidence={}))
        before = earlier.tasks.get(task.notebook, "") if earlier else ""
        kept = self._store.results(*work.key).get(before) if found else None
        if kept is None or not fits(task, kept):
            return replace(result, execution=self._store.keep(task, execution))
        self.fallen.add(found)
        self._store.adopt(task, before)
        return replace(result, execution=kept)

    def _why_again(self, work: Work) -> str:
        """Return why a notebook of a submission is executed again; empty if it is executed for the first time."""
        earlier = self._store.last_key(work)
        if earlier is None:
            return ""
        nothing = "--again was given" if self._asked.again else "its result was not kept"
        return work.made_from.changes_since(earlier) or nothing

    def worse(self, work: Work, rows: Iterable[Row]) -> Iterator[str]:
        """Yield a sentence if a newer hand-in has fewer points than the one before."""
        last, now = self._earlier.get(work.key), sum(row.score for row in rows)
        before = sum(row.score for row in last.rows) if last else 0.0
        if last and last.made_from.handed_in != work.made_from.handed_in and now < before:
            yield (
                f"{work.label}: the newer files have {now:g} points, those before had {before:g}. If they were "
                "collected, yes under use in collected.csv has the earlier file graded"
            )
