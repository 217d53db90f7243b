"""Finds, for each file in the inbox, its students, its notebook and its time; or the reason why they are unknown."""

from __future__ import annotations

import functools
import itertools
from collections import defaultdict
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.collected_files import BY_HAND, Line
from autograder.grading.collecting.file_owners import StudentOf
from autograder.grading.collecting.list_times import WAS_READ, ListTimes, entries_of, in_utc
from autograder.grading.collecting.submitted_file_names import base_of
from autograder.grading.collecting.systems import GRADESCOPE
from autograder.grading.rebuilding.submission_desk import read_notebook
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from datetime import tzinfo
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.collected_files import Arrival, Delivery, Inbox
    from autograder.grading.rebuilding.named_cells import Target
    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell
    from autograder.grading.table.roster import Roster


@dataclass(frozen=True)
class Edit:
    """What a person has written into a line of ``collected.csv``. An empty field changes nothing.

    Attributes:
        use: ``yes`` or ``no``.
        student: Student ids, separated by semicolons.
        assignment: The name of an assignment.
        notebook: The name of a notebook of that assignment.
        handed_in: A time in UTC, in the format of :meth:`datetime.isoformat`.
    """

    use: str = ""
    student: str = ""
    assignment: str = ""
    notebook: str = ""
    handed_in: str = ""


def lines_of(
    directory: ClassDirectory, inbox: Inbox, roster: Roster, edits: Mapping[str, Edit]
) -> list[Line]:
    """Return one line of ``collected.csv`` for each file, with what a person wrote or else what was found.

    But if a file was collected for two assignments, it has two lines.

    Args:
        directory: The class.
        inbox: The inbox of the class.
        roster: The students of the class.
        edits: What people have written into the table, by the key of the line.
    """
    assignments = _AssignmentOf(directory)
    entries = entries_of(inbox)
    read: list[tuple[Delivery, Line]] = []
    for id_, delivery in inbox.deliveries.items():
        # All lists, from any delivery, map numbers to students.
        student_of = StudentOf(roster, delivery.form, delivery.names, itertools.chain(*entries.values()))
        zone = ZoneInfo(delivery.zone) if delivery.zone else directory.time_zone
        reading = _Reading(inbox, directory.state, assignments, student_of, delivery, id_, zone)
        read += [(delivery, line) for line in reading.lines(edits)]
    timed = list(ListTimes(inbox, directory.time_zone).applied(read))
    clear = {line.key for line in timed if not line.reason}
    by_target: dict[tuple[str, str, str], list[Line]] = defaultdict(list)
    for line in timed:
        if line.key not in clear:
            by_target[line.key, "", ""].append(line)
        elif not line.reason:
            by_target[line.key, line.assignment, line.notebook].append(line)
    return [_merged(lines) for lines in by_target.values()]


@dataclass(frozen=True)
class _Reading:
    """Interprets the files of one delivery."""

    inbox: Inbox
    state: Path
    assignments: _AssignmentOf
    student_of: StudentOf
    delivery: Delivery
    id: str
    zone: tzinfo

    def lines(self, edits: Mapping[str, Edit]) -> Iterator[Line]:
        """Yield the line of each file. What a person wrote into an archive's line applies to the files in it, too."""
        opened: dict[tuple[str, tuple[str, ...]], Edit | None] = {}
        for arrival in self.delivery.arrivals:
            place, edit = (arrival.source, arrival.parts), edits.get(arrival.key, Edit())
            if arrival.is_archive:
                is_open = edit.student or self.delivery.student or not self._doubt(arrival)
                opened[place] = edit if is_open else None
                if is_open:
                    continue
            of_archive = opened.get(place, Edit()) if arrival.inner else Edit()
            if of_archive is not None:
                yield self._line(arrival, edit, of_archive)

    def _doubt(self, arrival: Arrival) -> str:
        why = self.student_of.doubt(self.student_of.owners(arrival))
        return f"{why}; {_ALONE}" if why and arrival.is_alone else why

    def _line(self, arrival: Arrival, edit: Edit, of_archive: Edit) -> Line:
        """Return the line of a file.

        Args:
            arrival: The file.
            edit: What a person wrote into the line of the file.
            of_archive: What a person wrote into the line of the student's archive that contains the file.
        """
        rank = bool(self.delivery.assignment) - bool(self.delivery.form or self.delivery.names)
        line = Line(arrival.key, arrival.label, arrival.content, use=edit.use, rank=rank)
        if arrival.is_list:
            return replace(line, reason=WAS_READ, is_soft=True, lms="list")
        if self.delivery.form == BY_HAND:
            # A person put the file into ``submitted``, where its path names the student and the notebook.
            student, assignment, name = arrival.parts
            owners = self.student_of.written(edit.student or student)[0] or (student,)
            notebook = name.removesuffix(SUFFIX)
            line = replace(line, students=owners, assignment=assignment, notebook=notebook)
            line = replace(line, lms=BY_HAND, file=arrival.path, is_sure=True)
        else:
            line = self._collected(line, arrival, edit, of_archive)
        if not edit.handed_in:
            return line
        return replace(line, when=datetime.fromisoformat(edit.handed_in), time_from="handed_in")

    def _collected(self, line: Line, arrival: Arrival, edit: Edit, of_archive: Edit) -> Line:
        """Return the line of a file that came from a system, completed with its students, notebook and time."""
        owners = self.student_of.owners(arrival)
        asked = edit.assignment or of_archive.assignment or self.delivery.assignment
        if written := edit.student or of_archive.student or self.delivery.student:
            ids, reason = self.student_of.written(written)
        else:
            reason = self._doubt(arrival)
            ids = () if reason else tuple(one.id for one in owners.students)
        if found := owners.facts:
            identity = found.identity
            line = replace(
                line,
                lms=identity.lms,
                number=identity.number or (identity.login if identity.name else ""),
                name=identity.name or identity.login,
                file="/".join(arrival.parts),
                when=in_utc(found.when, self.zone),
                order=found.order,
                late=found.late,
                is_sure=owners.is_sure or bool(written),
            )
            # A file's name may seem to contain an assignment. Believe it only if the class has such an assignment.
            asked = asked or (found.assignment if self.assignments.notebooks(found.assignment) else "")
        # Inside a student's own archive, a name identifies the notebook but not the student.
        name = found.file if found and not arrival.inner else arrival.name
        named = self.assignments.named(name if owners.students else arrival.name, asked)
        came_in = frozenset({f"{self.id}/{arrival.source}"})
        line = replace(line, students=ids, assignment=named, came_in=came_in)
        if arrival.refused:
            is_work = arrival.name.lower().endswith((".ipynb", ".zip")) or not ids
            return replace(line, reason=arrival.refused, is_soft=not is_work)
        if arrival.is_archive:
            is_nobodys = found is None and not owners.systems
            return replace(line, reason=_UNKNOWN_ARCHIVE if is_nobodys and not written else reason)
        data = self.inbox.read(arrival.content)
        if not _is_notebook(arrival.name, data):
            return _no_notebook(line, arrival)
        if reason:
            return replace(line, reason=reason)
        cells: Sequence[SubmittedCell] = ()
        try:
            cells, _ = read_notebook(data, self.state)
        except UnreadableSubmission as error:
            line = replace(line, unreadable=str(error))
        if edit.assignment or edit.notebook:
            return self._as_written(line, name, edit, asked)
        return self.assignments.completed(line, name, cells, asked)

    def _as_written(self, line: Line, name: str, edit: Edit, asked: str) -> Line:
        """Return the line completed with the notebook that a person wrote."""
        several = self.assignments.notebooks(asked)
        notebook = edit.notebook or (several[0] if len(several) == 1 else _stem_of(name))
        if notebook in several:
            return replace(line, assignment=asked, notebook=notebook)
        reason = f"write the name of the notebook under notebook ({', '.join(several)})"
        if not several:
            reason = f"the class has no assignment {asked or 'here'}: correct the name under assignment"
        return replace(line, assignment=asked if several else "", reason=reason)


_LMS_PAGES = ("index.html", "grades.csv", GRADESCOPE)
"""The names of files that an LMS adds to a download."""
_ALONE = "if it is or belongs to a download, collect that in a command of its own, with --from"
_OF_ONE_STUDENT = "If one student sent it, the folder has to be named after this student"
_UNKNOWN_ARCHIVE = (
    "the archive's name identifies no student. If it is a whole download, unpack it, and collect the folder. "
    f"{_OF_ONE_STUDENT}"
)
_OTHER_ARCHIVES = (".rar", ".7z", ".gz", ".bz2", ".xz", ".zst")


def _no_notebook(line: Line, arrival: Arrival) -> Line:
    """Return the line for a file that is not a notebook, such as a picture, or a page of the LMS."""
    if arrival.name in _LMS_PAGES and not arrival.inner and not line.students:
        return replace(line, assignment="", reason="the file is a page of the LMS", is_soft=True, lms="list")
    if arrival.name.lower().endswith(_OTHER_ARCHIVES):
        into = f" into a folder named {line.student}" if line.student else ""
        reason = f"archives of this kind are not opened: unpack the file{into}, and collect the folder"
        return replace(line, reason=reason if into else f"{reason}. {_OF_ONE_STUDENT}")
    return replace(line, reason="it is not a notebook", is_soft=True)


def _merged(several: Iterable[Line]) -> Line:
    """Return one line for a file that came several times: the one with the surest student, at the latest time."""
    lines = sorted(several, key=lambda one: (bool(one.reason), one.is_soft, one.rank, one.label))
    best = lines[0]
    came_in = frozenset().union(*(one.came_in for one in lines))
    timed = sorted((one for one in lines if one.when), key=lambda one: one.when or datetime.max) or [best]
    first, last = timed[0], timed[-1]
    return replace(best, came_in=came_in, when=last.when, time_from=last.time_from, first=first.when)


class _AssignmentOf:
    """Finds out which notebook of a class a collected file is, by the name and the cells of the file.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def notebooks(self, assignment: str) -> list[str]:
        """Return the notebooks of an assignment; none if the class has no assignment with this name."""
        return [
            notebook for several in self._notebooks.values() for of, notebook in several if of == assignment
        ]

    def named(self, name: str, asked: str) -> str:
        """Return ``asked`` or, if that is empty, the assignment in a file's name; empty if there is none."""
        stem = base_of(name.partition(".")[0])
        assignments = {assignment for assignment, _ in self._notebooks.get(stem.casefold(), ())}
        return asked or (assignments.pop() if len(assignments) == 1 else "")

    def completed(self, line: Line, name: str, cells: Sequence[SubmittedCell], asked: str) -> Line:
        """Return the line with its assignment and notebook, or with the reason why they are not certain.

        Args:
            line: The line of a notebook.
            name: The name that the student gave the file.
            cells: The cells of the file.
            asked: The assignment that the instructor named; empty to find it.
        """
        named = self._notebooks.get(_stem_of(name).casefold(), [])
        mixed = self._directory.named_cells.assignments(cells)
        cell_names = {cell.grade_id for cell in cells} - {""}
        held = self._directory.named_cells.closest(cell_names, asked if asked in mixed else "")
        meant = [target for target in named if not held or target in held] or held
        here = [target for target in meant if asked in ("", target[0])]
        is_at_odds = not asked and bool(named) and not set(named) & set(meant)
        disagree = is_at_odds or (len(mixed) > 1 and asked not in mixed)
        if meant and not here and not disagree:
            why = f"the file is the notebook of {meant[0][0]}, not of {asked}"
            reason = f"{why}; to collect the file for {meant[0][0]}, write {meant[0][0]} {_UNDER}"
            return replace(line, reason=reason, is_soft=True)
        here = here or [(asked, one) for one in self.notebooks(asked)]
        if len(here) == 1 and not disagree:
            return replace(line, assignment=here[0][0], notebook=here[0][1], is_named=here[0] in named)
        # A file with named cells of which none is from this class is another notebook of the course.
        is_foreign = not meant and bool(cell_names)
        possible = {asked} if asked else {target[0] for target in meant}
        if len(possible) == 1 and not disagree:
            (asked,) = possible
            which = f"which notebook of {asked} the file is ({', '.join(self.notebooks(asked))})"
            reason = f"it is not clear {which}: write the notebook under notebook in collected.csv"
        else:
            by_cells = {*mixed} or {target[0] for target in held}
            reason = self._unclear({target[0] for target in named}, by_cells)
        return replace(line, reason=line.unreadable or reason, is_soft=is_foreign)

    def _unclear(self, by_name: Collection[str], by_cells: Collection[str]) -> str:
        sources = {"name": by_name, "cells": by_cells}
        said = [f"{' or '.join(sorted(those))} by its {source}" for source, those in sources.items() if those]
        which = f"which assignment the file is for ({', '.join(said or self._directory.assignments())})"
        return f"it is not clear {which}: write the assignment {_UNDER}"

    @functools.cached_property
    def _notebooks(self) -> dict[str, list[Target]]:
        """Pairs of an assignment and a notebook, by the name of the notebook, which several assignments may use."""
        found: dict[str, list[Target]] = defaultdict(list)
        for assignment in self._directory.assignments():
            for name in self._directory.notebooks(assignment):
                found[name.casefold()].append((assignment, name))
        return dict(found)


_UNDER = "under assignment in collected.csv"


def _is_notebook(name: str, data: bytes) -> bool:
    """Return True if a file is a notebook, judged by its name or its content."""
    head = data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    held = head[:1] == b"{" and b'"nbformat"' in data and (b'"cells"' in data or b'"worksheets"' in data)
    return held or name.lower().endswith(SUFFIX)


def _stem_of(name: str) -> str:
    """Return the name of a file without ``.ipynb``, and without what programs add to a copy, such as `` (1)``."""
    end = name.lower().find(SUFFIX)
    return base_of(name[:end] if end > 0 else name.rpartition(".")[0] or name)
