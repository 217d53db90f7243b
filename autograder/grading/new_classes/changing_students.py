"""The command ``students``: compares a list of students with a class, shows the changes, and makes them.

A student who gets another id keeps all work, points and records. Ids are exchanged in two passes: first each old id
becomes the new id with a dot in front, which is the id of no student; then the dot goes. So two students can swap their
ids. The file ``.autograder/renaming.json`` says which pass is being made, so that a killed command can be finished.
"""

from __future__ import annotations

import contextlib
import itertools
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.class_store import ClassStore
from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.gradebook_reading import read_entries
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import INBOX_FOLDER, CollectedRecords, Inbox
from autograder.grading.collecting.submitted_folder import Submitted
from autograder.grading.grading_errors import GradingError, check_known, course_command
from autograder.grading.reporting.export_memory import ExportMemory
from autograder.grading.table.roster import NAME
from autograder.grading.table.student_list import RENAMING, accept_list, compare, enter_roster, read_known
from autograder.grading.table.students_csv import read_students_csv
from autograder.grading.tasks.fallen_points import FallenPoints
from autograder.kit.in_words import counted
from autograder.safe_files import remove_tree, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from autograder.grading.classes.gradebook_reading import Entries
    from autograder.grading.table.roster import Student
    from autograder.grading.table.student_list import KnownStudents, ListChanges

_MOST_UNCLEAR = 5
_FOLDERS = ("submitted", "autograded", "feedback")


def change_students(
    path: Path, new: Path | None, said: Mapping[str, str], *, is_final: bool, by_name: bool = False
) -> list[str]:
    """Compare a list of students with a class, and make the class use it.

    Args:
        path: The class directory.
        new: The new list, which replaces ``students.csv``; None if ``students.csv`` itself is the new list.
        said: The new ids of students, by their old ones, if the lists do not show that both are one student.
        by_name: True if students with the same name are the same students, as far as only one has the name.
        is_final: True to make the changes; False to only return what would change.

    Returns:
        Lines for the instructor.

    Raises:
        GradingError: The list cannot be used, or two ids of one student both have work that only a person can sort out.
    """
    directory = ClassDirectory(path)
    with directory.lock():
        lines = []
        if is_final and (directory.state / RENAMING).exists():
            _rename(directory, msgspec.json.decode((directory.state / RENAMING).read_bytes(), type=_Renaming))
            lines.append("An interrupted change of ids is finished now.")
        if new:  # remember the present list, unless it has changes that were not made yet
            with contextlib.suppress(GradingError):
                enter_roster(directory)
        place = new or directory.path / NAME
        file = read_students_csv(place)
        if not file.students:
            raise GradingError(
                f"{place} lists no student. See docs/instructor/students.md for what to write."
            )
        known, listed = read_known(directory), {one.id: one for one in file.students}
        check_known(list(said), sorted({**known.former, **known.listed}), "student of the class")
        check_known(list(said.values()), list(listed), "student of the list")
        changes = compare(known, listed, said)
        if by_name:
            changes = compare(known, listed, {**changes.unclear_alone, **said})
        entries = read_entries(directory.gradebook_url)
        _check_doubles(directory, changes, entries)
        lines += _lines(known, listed, changes, entries)
        if not is_final:
            options = [word for pair in said.items() for word in ("--rename", "=".join(pair))]
            options += ["--same-names"] if by_name else []
            words = ["students", path, *([new] if new else []), *options, "--yes"]
            return [*lines, f"Nothing was changed. To use this list, type {course_command(*words)}"]
        if new:
            write_whole(directory.path / NAME, new.read_bytes())
        if changes.renamed:
            _rename(directory, _Renaming(dict(changes.renamed)))
        accept_list(directory, read_students_csv(directory.path / NAME), {})
    if (directory.state / INBOX_FOLDER).exists():
        lines += [f"note      {note}" for note in collect(path).notes]
    return [*lines, f"Done. Then {course_command('grade', path)}"]


def _lines(
    known: KnownStudents, listed: Mapping[str, Student], changes: ListChanges, entries: Entries
) -> Iterator[str]:
    """Yield a line about each change."""
    before = {**known.former, **known.listed}

    def points(id_: str) -> str:
        own = [
            f"{name} {entry.points:g}" for (student, name), entry in sorted(entries.items()) if student == id_
        ]
        return f" ({', '.join(own)})" if own else ""

    for old, new in changes.renamed.items():
        of_other = "" if new in listed else ", because another student has the id now; not in the list"
        yield f"rename    {old} → {new}  {before[old].name}{points(old)}{of_other}"
    same = changes.unclear_alone
    if len(same) > _MOST_UNCLEAR:
        some = ", ".join(f"{old} → {new}" for old, new in list(same.items())[:3])
        yield (
            f"unclear   {len(same)} students have the same names as before, other ids, and no number that tells them "
            f"apart: {some} …: add --same-names if they are the same students"
        )
    for old, new in changes.unclear:
        if len(same) > _MOST_UNCLEAR and old in same:
            continue
        yield (
            f"unclear   {old}, {new}  have the same name, {before[old].name}, and no number that tells them apart: add "
            f"--rename {old}={new} if they are one student; otherwise {old} is dropped and {new} is added"
        )
    for old in changes.dropped:
        kept = (
            "; these points stay in the gradebook, but are in no table and no export" if points(old) else ""
        )
        yield f"drop      {old}  {before[old].name}{points(old)}{kept}"
    for new in changes.added:
        yield f"add       {new}  {listed[new].name}{points(new)}"
    for one, old, new in changes.renumbered:
        yield (
            f"number    {one}  {listed[one].name}: {old} → {new}{points(one)}: taken for the same student. If this is "
            "another person, give that person another id in the list"
        )
    for one, old, new in changes.moved:
        yield f"section   {one}  {listed[one].name}: {old} → {new or 'none'}"
    yield f"{counted(len(listed), 'student')} in the list"


def _check_doubles(directory: ClassDirectory, changes: ListChanges, entries: Entries) -> None:
    """Check that work and points under two ids of one student can be put together.

    Raises:
        GradingError: A person has put both notebooks into ``submitted``, or has given points under the old id.
    """
    inbox, records = Inbox(directory.state), CollectedRecords(directory.state)
    submitted, place = Submitted(directory, inbox), directory.path / "submitted"
    pairs = [(old, new) for old, new in changes.renamed.items() if new not in changes.renamed]
    for (old, new), assignment in itertools.product(pairs, directory.assignments()):
        collected, entry = records.get(assignment, old), entries.get((old, assignment))
        for notebook in directory.notebooks(assignment) if (place / new / assignment).exists() else ():
            content = submitted.content((old, assignment, notebook))
            if content and not (collected and content in collected.written(notebook) and content in inbox):
                raise GradingError(
                    f"{old} and {new} are one student, and both have work for {assignment} that was put into {place} "
                    f"by hand: move the folder that does not count, {place / old / assignment} or "
                    f"{place / new / assignment}, out of the class. Then type the same command again"
                )
        if (new, assignment) in entries and entry and entry.has_points_by_hand:
            raise GradingError(
                f"{old} and {new} are one student, and a person has given {old} points for {assignment}, where {new} "
                f"has points, too: in formgrader, give {new} the points that count, and empty those of {old}. Then "
                "type the same command again"
            )


class _Renaming(msgspec.Struct):
    """A change of ids that is being made: the new ids by the old ones, and which of the two passes is being made."""

    ids: dict[str, str]
    is_second: bool = False


def _rename(directory: ClassDirectory, renaming: _Renaming) -> None:
    """Give students other ids in everything that belongs to a class. If this is interrupted, do it again.

    Raises:
        OSError: A file could not be written.
    """
    journal, between = directory.state / RENAMING, {new: f".{new}" for new in renaming.ids.values()}
    write_whole(journal, msgspec.json.encode(renaming))
    if not renaming.is_second:
        _make_pass(directory, {old: between[new] for old, new in renaming.ids.items()})
        write_whole(journal, msgspec.json.encode(_Renaming(renaming.ids, is_second=True)))
    _make_pass(directory, {dotted: new for new, dotted in between.items()})
    accept_list(directory, read_students_csv(directory.path / NAME), renaming.ids)
    journal.unlink()


def _make_pass(directory: ClassDirectory, ids: Mapping[str, str]) -> None:
    CollectedRecords(directory.state).rename(ids)
    Table(directory).rename(ids)
    ExportMemory(directory.state).rename(ids)
    FallenPoints(directory.state).rename(ids)
    for old, new in ids.items():
        for name in _FOLDERS:
            _move(directory.path / name / old, directory.path / name / new)
    gradebook_writing.rename(directory.gradebook_url, ids)
    with ClassStore(directory) as store:
        store.rename(ids)


def _move(folder: Path, to: Path) -> None:
    """Move a student's folder. If the student has a folder of an assignment in both places, the one in ``to`` stays."""
    if not to.exists() and folder.exists():
        folder.rename(to)
    for one in folder.iterdir() if folder.exists() else ():
        if not (to / one.name).exists():
            one.rename(to / one.name)
    if folder.exists():
        remove_tree(folder)
