"""Finds the submissions to grade in a run, and computes what a dry run reports."""

from __future__ import annotations

import contextlib
import hashlib
from dataclasses import dataclass, replace
from datetime import UTC
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.command_name import COMMAND
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.gradebook_reading import CellEntry, SubmissionEntry, read_due_dates
from autograder.grading.classes.student_folders import RefusedFile
from autograder.grading.collecting.collected_csv import NAME, Table
from autograder.grading.collecting.collected_files import Inbox
from autograder.grading.grading_errors import MasterUnusable, check_known, course_command
from autograder.grading.rebuilding.submission_desk import forget_documents
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.reporting.class_table import Difference
from autograder.grading.table.rows import LATE, Row
from autograder.grading.tasks.submission_times import handed_in_at, is_not_believed
from autograder.grading.tasks.submission_work import Work

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from datetime import datetime

    from autograder.grading.class_records import Attempt
    from autograder.grading.classes.class_dates import ClassDates
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.classes.gradebook_reading import Entries
    from autograder.grading.grading_task import GradedCell
    from autograder.grading.table.roster import Roster
    from autograder.grading.tasks.asked_for import AskedFor
    from autograder.grading.tasks.result_keys import ResultKeys
    from autograder.grading.tasks.source_points import Released
    from autograder.grading.tasks.submission_work import Entered


@dataclass(frozen=True)
class FoundWork:
    """The submissions of a class, with refused files and notices.

    Attributes:
        works: The chosen submissions.
        others: The other submissions of the class, and those of students whom ``students.csv`` does not list.
        refused: Files and folders that cannot be graded, each with the reason.
        notices: Sentences for the instructor.
    """

    works: list[Work]
    others: list[Work]
    refused: list[RefusedFile]
    notices: list[str]


def find_work(
    directory: ClassDirectory,
    asked: AskedFor,
    released: Released,
    roster: Roster,
    keys: ResultKeys,
    beside: Iterable[RefusedFile],
) -> FoundWork:
    """Find the submissions of a class, and select the chosen ones.

    Args:
        asked: The chosen students and assignments.
        released: The cells with points in the source notebooks.
        keys: Computes the key of a submission.
        beside: Files in ``submitted`` that lie in a wrong folder.

    Raises:
        MasterUnusable: An assignment that was chosen by name cannot be graded.
        GradingError: A chosen name is not an assignment or a student.
    """
    submissions, refused = directory.submissions()
    result = FoundWork([], [], refused, [])
    result.refused.extend([*beside, *_unusable(directory, asked, released), *_unplaced(directory, asked)])
    submissions = [one for one in submissions if one.assignment in released.cells]
    check_known(asked.assignments, directory.assignments(), "assignment")
    students = {submission.student for submission in submissions}
    # If the student's folder is refused, do not also report the student as unknown.
    students |= {one.path.name for one in refused if one.path.parent == directory.path / "submitted"}
    check_known(asked.students, sorted(students | roster.students.keys()), "student")
    names = {assignment: directory.notebooks(assignment) for assignment in released.cells}
    for submission in submissions:
        work = Work(*submission.key, submission.folder, keys.of(submission), names[submission.assignment])
        if is_not_believed(submission.folder):
            result.notices.append(
                f"{work.label}: timestamp.txt is ignored, because "
                f"`{COMMAND} collect` did not write it. To set the time of handing in, first type "
                f"{course_command('collect', directory.path)}. Then write the time into the column handed_in of "
                f"this submission's line in {NAME}, and type the same command again."
            )
        # Work of a student whom the list does not have is graded only if the instructor names the student.
        is_chosen = roster.has(submission.student) or submission.student in asked.students
        (result.works if is_chosen and asked.has(*work.key) else result.others).append(work)
    return result


def _unusable(directory: ClassDirectory, asked: AskedFor, released: Released) -> Iterator[RefusedFile]:
    """Yield the assignments that cannot be graded, because their source notebooks cannot be used.

    Raises:
        MasterUnusable: An assignment that was chosen by name cannot be graded.
    """
    for name, reason in released.unusable.items():
        if name in asked.assignments:
            raise MasterUnusable(reason)
        if not asked.assignments:
            yield RefusedFile(directory.path / "source" / name, f"{reason} The other assignments are graded.")


def _unplaced(directory: ClassDirectory, asked: AskedFor) -> Iterator[RefusedFile]:
    """Yield the collected files for which the instructor still has to say to which submission they belong."""
    table = Table(directory)
    for one in table.waiting():
        if asked.has(one.student, one.assignment) or not (one.student and one.assignment):
            yield RefusedFile(Path(one.label), one.sentence, waits=True)
    if table.is_edited:
        path = directory.path
        yield RefusedFile(
            path / NAME,
            f"the file was edited after the last collect: to use the changes, type {course_command('collect', path)}",
        )


def would_change(
    directory: ClassDirectory,
    submissions: Iterable[Entered],
    entries: Entries,
    cells: Mapping[str, Sequence[GradedCell]],
    dates: ClassDates,
) -> list[Difference]:
    """Return the changes of points that a run would make, by new verdicts or a late penalty.

    Args:
        submissions: The submissions after the dry run. Those that it graded have no entry.
        cells: The cells with points, by assignment.
        dates: The due dates and extensions of ``class.toml``.
    """
    changes = []
    due = read_due_dates(directory.gradebook_url)
    for one in submissions:
        work = one.work
        entry = entries.get(work.key, SubmissionEntry())
        by_exercise = {cell.exercise: cell for cell in cells[work.assignment]}
        for row in one.rows if one.entry is None else ():
            cell = by_exercise[row.exercise]
            cell_entry = entry.cells.get(cell.notebook, {}).get(cell.name)
            before = cell_entry.judged if cell_entry else None
            if before != row.score:
                note = (
                    "the points that a person gave stay"
                    if cell_entry and cell_entry.by_hand is not None
                    else ""
                )
                changes.append(
                    Difference(*work.key, row.exercise, before, row.score, "", row.diagnosis, note)
                )
        at = dates.of(*work.key, entry.due or due.get(work.assignment))
        then = _foreseen(one, entry, by_exercise, at)
        if then.is_late or entry.penalty:
            from autograder.grading.table.late_policy import (
                penalties,
            )  # imported here because the module imports nbgrader, which takes a second

            costs = penalties(directory.config, work.student, then)
            then = replace(then, penalties={name: cost or 0.0 for name, cost in costs.items()})
            if then.taken_off != entry.taken_off:
                before, after = (-each.taken_off if each.taken_off else None for each in (entry, then))
                changes.append(
                    Difference(*work.key, LATE, before, after, note=then.why_late(directory.time_zone))
                )
    return changes


def moved_points(work: Work, rows: Iterable[Row], earlier: Attempt | None) -> Iterator[Difference]:
    """Yield the judge's points that differ from those of the attempt before, although the submission is the same.

    Args:
        rows: The new results of the submission.
        earlier: The attempt that was in the gradebook before; None if there was none.
    """
    if earlier is not None and earlier.made_from.handed_in == work.made_from.handed_in:
        before = {row.exercise: row for row in earlier.rows}
        for row in rows:
            old = before.get(row.exercise, row)
            if old.score != row.score:
                points, diagnoses = (old.score, row.score), (old.diagnosis, row.diagnosis)
                yield Difference(*work.key, row.exercise, *points, *diagnoses)


def _foreseen(
    one: Entered, entry: SubmissionEntry, by_exercise: Mapping[str, GradedCell], due: datetime | None
) -> SubmissionEntry:
    """Return the gradebook entry that a run would make for a submission, but with the old late penalty."""
    cells = {notebook: dict(of_notebook) for notebook, of_notebook in entry.cells.items()}
    for row in one.rows if one.entry is None else ():
        cell = by_exercise[row.exercise]
        of_notebook = cells.setdefault(cell.notebook, {})
        of_notebook[cell.name] = replace(of_notebook.get(cell.name, CellEntry(cell.worth)), judged=row.score)
    at = entry.handed_in
    with contextlib.suppress(ValueError):  # a run rejects the submission if its time is invalid
        at = handed_in_at(one.work.folder, believed=at) or at
    return replace(entry, handed_in=at, due=due, cells=cells)


def due_dates(directory: ClassDirectory, assignments: Collection[str]) -> dict[str, datetime]:
    """Return the due dates of assignments by name, in the time zone of the class."""
    return {
        name: due.replace(tzinfo=UTC).astimezone(directory.time_zone)
        for name, due in sorted(read_due_dates(directory.gradebook_url).items())
        if name in assignments
    }


def unlisted_notice(works: Sequence[Work]) -> Iterator[str]:
    """Yield a sentence about work of students whom ``students.csv`` does not list, if there is any."""
    if works:
        names = ", ".join(work.label for work in works)
        yield (
            f"students.csv does not list these students, so this work is not graded: {names}. To grade it anyway, "
            f"add --student {works[0].student}"
        )


def without_grade(row: Row) -> Row:
    """Return a row with zero points for a result that could not be entered into the gradebook."""
    reason = "The result could not be entered into the gradebook; the exercise has zero points there."
    return replace(row, score=0.0, state="not_checked", diagnosis="not_written_down", reason=reason)


def forget_unneeded_documents(directory: ClassDirectory) -> None:
    """Remove what was read from files that are neither in ``submitted`` nor in the inbox any more."""
    needed = Inbox(directory.state).contents
    for submission in directory.submissions()[0]:
        for name in directory.notebooks(submission.assignment):
            with contextlib.suppress(UnreadableSubmission):
                data = read_bytes(submission.folder / f"{name}{SUFFIX}")
                needed.add(hashlib.sha256(data).hexdigest())
    forget_documents(directory.state, needed)
