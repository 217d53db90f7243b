"""Finds, for each file in the inbox, its students, its notebook and its time; or the reason why they are unknown."""

from __future__ import annotations

import functools
from collections import defaultdict
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

from autograder.grading.classes.class_directory import SUFFIX, reason_against_name
from autograder.grading.collecting.deciding.assignment_of import AssignmentOf, NoTarget, is_notebook, stem_of
from autograder.grading.collecting.deciding.student_of import Owners, StudentOf
from autograder.grading.collecting.inbox import BY_HAND
from autograder.grading.collecting.reading.desk import read_list
from autograder.grading.collecting.reading.lists import GRADESCOPE, Entry
from autograder.grading.collecting.records import repository_in
from autograder.grading.table.roster import Identity, Roster, Student

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from datetime import tzinfo

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.inbox import Arrival, Delivery, Inbox
    from autograder.grading.rebuilding.named_cells import Target

PAGES = ("index.html", "grades.csv", GRADESCOPE)
"""Files that the system itself adds to a download."""
_OTHER_ARCHIVES = (".rar", ".7z", ".gz", ".bz2", ".xz", ".zst")


@dataclass(frozen=True)
class Edit:
    """What a person has written into a line of ``collected.csv``. An empty cell changes nothing.

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


@dataclass(frozen=True)
class Line:
    """A line of ``collected.csv``: one file, with everything known about it.

    Attributes:
        key: The key that identifies the line in ``collected.csv``.
        label: The name of the file in messages.
        content: The hash of the file's bytes.
        students: The ids of the students to whom the file belongs; empty if they are unknown.
        assignment: The name of the assignment; empty if it is unknown. For a file that is not a notebook, the
            assignment that its name means.
        notebook: The name of the notebook; empty if it is unknown, or if the file is not a notebook.
        when: The time of handing in, in UTC.
        order: A number that increases with later files of one student, if the system numbers files.
        late: True if the system marks the file as late.
        use: ``yes`` or ``no``, as a person wrote it; empty if no person did.
        reason: Why the file cannot count, and what to do.
        is_soft: True if the file needs no attention once a notebook of its student was collected, as for a picture next
            to it.
        what_to_do: What to do if no such notebook is collected.
        lms, number, name, file: The system, and its names for the student and the file.
        number_of_copy: The number that a browser has added to the file's name.
        is_named: True if the file has the name of the notebook.
        is_sure: True if a number of the system identifies the student, not just a name that students may choose.
        readings: The ways in which the name of the file can be read as a student's.
        repository: The repository on GitHub that contained the file.
        came_in: The downloads that contained the file.
        rank: Lower if the command named the system, and higher if it named the assignment. If a file came several
            times, the line with the lowest rank is preferred.
    """

    key: str
    label: str
    content: str = ""
    students: tuple[str, ...] = ()
    assignment: str = ""
    notebook: str = ""
    when: datetime | None = None
    order: int = 0
    late: bool = False
    use: str = ""
    reason: str = ""
    is_soft: bool = False
    what_to_do: str = ""
    lms: str = ""
    number: str = ""
    name: str = ""
    file: str = ""
    number_of_copy: int = 0
    is_named: bool = False
    is_sure: bool = False
    readings: tuple[Identity, ...] = ()
    repository: str = ""
    came_in: frozenset[str] = field(default_factory=frozenset)
    rank: int = 0

    @property
    def is_by_hand(self) -> bool:
        """True if a person put the file into ``submitted``."""
        return self.lms == BY_HAND


class Proposals:
    """Interprets the files in the inbox, using what is known about the class.

    Args:
        directory: The class.
        inbox: The inbox of the class.
        roster: The students of the class.
        edits: What people have written into the table, by the key of the line.
    """

    def __init__(
        self, directory: ClassDirectory, inbox: Inbox, roster: Roster, edits: Mapping[str, Edit]
    ) -> None:
        self._directory = directory
        self._inbox = inbox
        self._roster = roster
        self._edits = edits
        self._assignments = functools.cache(lambda asked: AssignmentOf(directory, asked))
        self._names = frozenset(directory.assignments())
        self._entries = entries_of(inbox)

    def student_of(self, delivery: Delivery, id_: str = "") -> StudentOf:
        """Return what is known about students' names for the files of a delivery.

        All lists, from any delivery, are used to map numbers to students. But the times in a list apply only to files
        in the same delivery, because a later list may be about a later file. A list that came alone applies to all
        files.
        """
        alone = (
            one for one, of in self._inbox.deliveries.items() if all(file.is_list for file in of.arrivals)
        )
        known = [entry for entries in self._entries.values() for entry in entries]
        own = self._entries.get(id_, [])
        others = [entry for one in alone if one != id_ for entry in self._entries[one]]
        return StudentOf(
            self._roster, self._assignments("").is_notebook, delivery.form, delivery.names, known, own, others
        )

    def lines(self) -> list[Line]:
        """Return one line of ``collected.csv`` for each file. What a person wrote takes precedence over what was found.

        A file that was collected for two assignments has two lines.
        """
        found: dict[str, list[Line]] = defaultdict(list)
        for id_, delivery in self._inbox.deliveries.items():
            for line in self._of_delivery(id_, delivery):
                found[line.key].append(line)
        lines = []
        for several in found.values():
            targets: dict[tuple[str, str], list[Line]] = defaultdict(list)
            for one in several:
                if not one.reason:
                    targets[one.assignment, one.notebook].append(one)
            lines += [_merged(ones) for ones in targets.values()] or [_merged(several)]
        return lines

    def _of_delivery(self, id_: str, delivery: Delivery) -> Iterator[Line]:
        student_of = self.student_of(delivery, id_)
        zone = ZoneInfo(delivery.zone) if delivery.zone else self._directory.time_zone
        reading = _Reading(self, student_of, delivery, id_, zone)
        unopened = set()
        for arrival in delivery.arrivals:
            place = (arrival.source, arrival.parts)
            edit = self._edits.get(arrival.key, Edit())
            if arrival.is_archive:
                is_open = edit.student or not student_of.reason_against(reading.owners(arrival))
                if is_open:
                    reading.given[place] = edit
                    continue
                unopened.add(place)
            elif arrival.inner and place in unopened:
                continue
            yield reading.line(arrival, edit)

    def data(self, content: str) -> bytes:
        """Return the bytes of a file, given their hash."""
        return self._inbox.read(content)

    def target(self, name: str, content: str, asked: str) -> tuple[Target, bool]:
        """Return the notebook to which a file belongs, and whether the file's name agrees."""
        return self._assignments(asked).target(name, self._inbox.read(content))

    def named(self, name: str, asked: str) -> str:
        """Return the assignment that a file's name means; empty if it means none."""
        return self._assignments(asked).named(name)

    def notebooks(self, assignment: str) -> list[str]:
        """Return the notebooks of an assignment; none if the class has no assignment with this name."""
        return self._directory.notebooks(assignment) if assignment in self._names else []

    def known(self, written: str) -> tuple[tuple[str, ...], str]:
        """Return the ids of the students that a person wrote into a cell, or what is wrong with the cell."""
        ids = []
        for one in (part.strip() for part in written.replace(",", ";").split(";") if part.strip()):
            found = self._roster.find(Identity(login=one, name=one)) or self._without_zeros(one)
            if len(found) != 1 and self._roster.students:
                return (), f"students.csv has no student {one}: correct the cell student"
            id_ = found[0].id if found else one
            if reason := reason_against_name(id_):
                return (), f"{id_} cannot be a student's id: {reason}: correct the cell student"
            ids.append(id_)
        return tuple(ids), ""

    def _without_zeros(self, written: str) -> tuple[Student, ...]:
        """Return the student whose id equals this number after a spreadsheet has dropped leading zeros."""
        plain = written.removesuffix(",0").removesuffix(".0").lstrip("0")
        alike = [one for one in self._roster.students.values() if one.id.lstrip("0") == plain]
        return tuple(alike) if plain.isdecimal() and len(alike) == 1 else ()


class _Reading:
    """Interprets the files of one delivery.

    Attributes:
        given: What a person wrote about a student's archive, which applies to the files in it.
    """

    def __init__(
        self, proposals: Proposals, student_of: StudentOf, delivery: Delivery, id_: str, zone: tzinfo
    ) -> None:
        self._proposals = proposals
        self._student_of = student_of
        self._delivery = delivery
        self._id = id_
        self._zone = zone
        self.given: dict[tuple[str, tuple[str, ...]], Edit] = {}

    def owners(self, arrival: Arrival) -> Owners:
        """Return the students that the name of a file identifies."""
        return self._student_of.owners(arrival.parts, arrival.levels, is_alone=arrival.is_own)

    def line(self, arrival: Arrival, edit: Edit) -> Line:
        """Return the line for a file, with what a person wrote into it."""
        rank = bool(self._delivery.assignment) - bool(self._delivery.form or self._delivery.names)
        line = Line(arrival.key, arrival.label, arrival.content, use=edit.use, rank=rank)
        if arrival.is_list:
            return replace(line, reason="it was read as a list", is_soft=True, lms="list")
        by_hand = self._delivery.form == BY_HAND
        line = _by_hand(line, arrival) if by_hand else self._collected(line, arrival, edit)
        if edit.handed_in:
            line = replace(line, when=datetime.fromisoformat(edit.handed_in))
        return line

    def _collected(self, line: Line, arrival: Arrival, edit: Edit) -> Line:
        owners, found = self.owners(arrival), None
        given = self.given.get((arrival.source, arrival.parts), Edit())
        written = edit.student or given.student
        asked = edit.assignment or given.assignment or self._delivery.assignment
        reason = self._student_of.reason_against(owners)
        ids = () if reason else tuple(one.id for (one,) in owners.members)
        if written:
            ids, reason = self._proposals.known(written)
        if (found := owners.found) is not None:
            identity = found.identity
            when = in_utc(found.when or self._student_of.time(identity), self._zone)
            line = replace(
                line,
                lms=identity.lms,
                number=identity.number or (identity.login if identity.name else ""),
                name=identity.name or identity.login,
                file="/".join(arrival.parts),
                when=when or self._delivery.handed_in,
                order=found.order,
                late=found.late,
                is_sure=owners.is_sure or bool(written),
                readings=found.readings[:1] or (identity,),
                repository=repository_in(identity.lms, arrival.parts, identity.number or identity.name),
            )
            # An assignment in a name counts only if the class has an assignment with that name.
            asked = asked or (found.assignment if self._proposals.notebooks(found.assignment) else "")
        line = replace(line, students=ids, came_in=frozenset({f"{self._id}/{arrival.source}"}))
        # Inside a student's own archive, a name identifies the notebook but not the student.
        own_name = found.file if found and not arrival.inner else arrival.name
        named = self._proposals.named(own_name if owners.members else arrival.name, asked)
        if arrival.refused:
            is_work = arrival.name.lower().endswith((".ipynb", ".zip")) or not ids
            return replace(line, assignment=named, reason=arrival.refused, is_soft=not is_work)
        data = self._proposals.data(arrival.content)
        if arrival.is_archive:
            return replace(line, assignment=named, reason=reason)
        if not is_notebook(arrival.name, data):
            return self._no_notebook(line, arrival.name, named, is_inner=bool(arrival.inner))
        if reason:
            return replace(line, assignment=named, reason=reason)
        return self._with_target(line, own_name, edit, asked)

    def _with_target(self, line: Line, name: str, edit: Edit, asked: str) -> Line:
        """Return the line completed with its notebook, or with the reason why that is unclear."""
        if edit.assignment or edit.notebook:
            return self._as_written(line, name, edit, asked)
        try:
            (assignment, notebook), is_named = self._proposals.target(name, line.content, asked)
        except NoTarget as error:
            is_soft = error.is_left_out or bool(error.assignment)
            named = error.assignment or self._proposals.named(name, asked)
            return replace(line, assignment=named, reason=str(error), is_soft=is_soft)
        return replace(
            line,
            assignment=assignment,
            notebook=notebook,
            is_named=is_named,
            number_of_copy=stem_of(name)[1],
        )

    def _as_written(self, line: Line, name: str, edit: Edit, asked: str) -> Line:
        """Return the line completed with the notebook that a person wrote."""
        several = self._proposals.notebooks(asked) if asked else []
        stem = stem_of(name)[0]
        notebook = (
            edit.notebook or (stem if stem in several else "") or (several[0] if len(several) == 1 else "")
        )
        if notebook not in several:
            known = ", ".join(several)
            reason = (
                f"write its notebook under notebook ({known})"
                if several
                else f"the class has no assignment {asked or 'here'}: correct the cell assignment"
            )
            return replace(line, assignment=asked if several else "", reason=reason)
        return replace(line, assignment=asked, notebook=notebook, number_of_copy=stem_of(name)[1])

    def _no_notebook(self, line: Line, name: str, named: str, *, is_inner: bool) -> Line:
        """Return the line for a file that is not a notebook, such as a picture, or a page of the LMS."""
        if name in PAGES and not is_inner and not line.students:
            return replace(line, reason="it is a page of the LMS", is_soft=True, lms="list")
        student = line.students[0] if len(line.students) == 1 else "STUDENT"
        line = replace(line, assignment=named)
        if name.lower().endswith(_OTHER_ARCHIVES):
            what = "it is an archive that is not opened here: unpack it into a folder named"
            return replace(line, reason=f"{what} {student}, and collect that")
        what_to_do = "ask for the notebook, or write no under use"
        return replace(line, reason="it is not a notebook", what_to_do=what_to_do, is_soft=True)


def _by_hand(line: Line, arrival: Arrival) -> Line:
    """Return the line completed for a file that a person put into ``submitted``: its path shows everything."""
    student, assignment, name = arrival.parts
    return replace(
        line,
        students=(student,),
        assignment=assignment,
        notebook=name.removesuffix(SUFFIX),
        lms=BY_HAND,
        file=arrival.path,
        is_sure=True,
    )


def in_utc(when: datetime | None, zone: tzinfo) -> datetime | None:
    """Return a time in UTC; None for a time that cannot be converted, such as one in the year 1 or 9999."""
    if when is None:
        return None
    try:
        return (when if when.tzinfo else when.replace(tzinfo=zone)).astimezone(UTC)
    except (OverflowError, ValueError):
        return None


def entries_of(inbox: Inbox) -> dict[str, list[Entry]]:
    """Return the entries of all lists in the inbox, by delivery."""
    return {
        id_: [
            entry
            for one in delivery.arrivals
            if one.is_list
            for entry in read_list(one.name, inbox.read(one.content)) or []
        ]
        for id_, delivery in inbox.deliveries.items()
    }


def _merged(several: Iterable[Line]) -> Line:
    """Return one line for a file that came several times, with the most certain facts and the latest time."""
    lines = sorted(several, key=lambda one: (bool(one.reason), one.is_soft, one.rank, one.label))
    best = lines[0]
    when = max((one.when for one in lines if one.when), default=None)
    came_in = frozenset().union(*(one.came_in for one in lines))
    return replace(best, when=when, came_in=came_in)


def list_trouble(name: str, data: bytes) -> str:
    """Return why a list cannot be used; empty if it can."""
    if read_list(name, data) is None:
        return (
            "it is none of the lists that are known, or too large for one: Moodle's grading worksheet, Canvas's "
            "gradebook or its submissions, GitHub Classroom's grades or Gradescope's scores. Times belong into the "
            "column handed_in of collected.csv, a list of your students into students.csv of the class"
        )
    return ""
