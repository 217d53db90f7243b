"""Finds a file's student: compares its name with the list of students and with the lists of the download."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import reason_against_name
from autograder.grading.collecting.forms import FORMS, plain, read_path
from autograder.grading.table.roster import Identity, Roster, Student

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from datetime import datetime

    from autograder.grading.collecting.forms import Found
    from autograder.grading.collecting.lists import Entry

_NO_ID = "its name does not say whose it is: say --from, or put it into a folder with the student's id and collect that"


@dataclass(frozen=True)
class Owners:
    """The students who may have handed in a file, as its name says.

    Attributes:
        found: The facts in the name; None where it has no known form.
        members: For each member of the group, the students who may be meant; empty where nobody is known.
    """

    found: Found | None
    members: tuple[tuple[Student, ...], ...] = ()

    @property
    def only(self) -> Student | None:
        """The student; None where the file is of no student, of a group, or may be of several."""
        students = [student for members in self.members for student in members]
        return students[0] if len(students) == 1 else None


class StudentOf:
    """Knows the students of a class by all names that systems have for them.

    Args:
        roster: The students of the class.
        entries: Entries of lists that came with a download; each is about the files that have its number.
        told: Entries of lists that the instructor gives for their times; they count for work from any system.
    """

    def __init__(self, roster: Roster, entries: Iterable[Entry] = (), told: Iterable[Entry] = ()) -> None:
        self._roster = roster
        self._told = list(told)
        self._by_number = {(one.lms, one.number): one for one in (*entries, *self._told) if one.number}

    def find(self, way: Found) -> Owners | None:
        """The students who may be meant, by the first way of reading the name that names one."""
        readings = way.readings if self._roster.students and way.readings else (way.identity,)
        for identity in readings:
            if members := self._of(identity):
                return Owners(replace(way, identity=identity), members)
        return None

    def likely_forms(
        self, paths: Iterable[Sequence[str]], depth: int, is_notebook: Callable[[str], bool]
    ) -> list[str]:
        """The form that most names of a download have, and those that as many have; empty where more are plain folders.

        Whatever a student calls a file, the system's own part is in front of it: no other form fits more names. And a
        student chooses the names of files in a folder that is called as a student is, and might choose one that another
        system would give to somebody else's.

        Args:
            paths: Of its files.
            depth: The number of folders with names that may say a student.
            is_notebook: Whether a file of this name is a notebook of the class.
        """
        votes: dict[str, set[tuple[str, ...]]] = {form: set() for form in FORMS}
        in_folders = set()
        for path in filter(None, paths):
            folder = tuple(path[:depth])  # which has one vote, however many files its student puts into it
            if any(map(self.find, plain(path)[:depth])):
                in_folders.add(folder)
            for form in FORMS:
                if read_path(path, form, is_notebook) is not None:
                    votes[form].add(folder)
        most = max(map(len, votes.values()))
        return [form for form in FORMS if len(votes[form]) == most] if most > len(in_folders) else [""]

    def rival(
        self, path: Sequence[str], found: Found, forms: Iterable[str], is_notebook: Callable[[str], bool]
    ) -> str:
        """The form by which a name means another known student, or another time; empty where none does."""
        owners = self.find(found)
        if owners is None or not self._roster.students:  # without a list, each reading is somebody's
            return ""
        for form in forms:
            # Google's form is that of many other names.
            other = read_path(path, form, is_notebook) if form != "google" else None
            meant = self.find(other) if other is not None else None
            if other and meant and (owners.members, found.when) != (meant.members, other.when):
                return form
        return ""

    def _of(self, identity: Identity) -> tuple[tuple[Student, ...], ...]:
        """The students who may be meant; in a class without a list of students, the one that the LMS names."""
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        if known is not None:
            sure = tuple(student for names in known.members if (student := self._first(names)))
            if sure and len(sure) == len(known.members):
                return tuple((student,) for student in sure)
        # What students.csv has of Moodle is another number: this one is one student's in one assignment.
        found = self._roster.find(replace(identity, number="") if identity.lms == "moodle" else identity)
        called = identity.login or identity.name
        if not found and not self._roster.students and identity.lms and called:
            found = (Student(called),)
        return (found,) if found else ()

    def _first(self, names: Iterable[Identity]) -> Student | None:
        """The student of the first of several names that is one student's alone."""
        return next((hit[0] for name in names if len(hit := self._roster.find(name)) == 1), None)

    def reason_against(self, owners: Owners) -> str:
        """The reason why a file cannot be taken as a student's, and what to do; empty where it can."""
        if owners.found is None:
            return _NO_ID
        identity = owners.found.identity
        if not owners.members:
            return self._unknown(identity)
        for students in owners.members:
            if len(students) > 1:
                return _of_several(identity, students)
            if reason := reason_against_name(students[0].id):
                return f"{students[0].id} cannot be a student's id: {reason}. List it in students.csv"
        return ""

    def _unknown(self, identity: Identity) -> str:
        number = identity.number or identity.login
        known = self._by_number.get((identity.lms, number))
        called = " and ".join(str(names[-1]) for names in known.members if names) if known else str(identity)
        nobody = f"nobody in the class is called {called or number}: add a line to students.csv, or"
        if identity.lms == "moodle":
            return f"{nobody} {_with_worksheet(number)}"
        return (
            f"{nobody} the id that {identity.lms.capitalize()} uses ({number}) to the column {identity.lms}"
        )

    def time(self, identity: Identity, student: str, assignment: str) -> datetime | None:
        """The time at which a list says that somebody handed in, in its own time zone; None where none says so."""
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        if known is not None and known.when is not None:
            return known.when
        return self.time_of(student, assignment)

    def time_of(self, student: str, assignment: str) -> datetime | None:
        """The same of a student, by whatever name a list has."""
        times = self._times
        return times.get((student, assignment), times.get((student, "")))

    @property
    def strangers(self) -> list[str]:
        """The names in a list of times that are no student's of the class."""
        return [
            str(names[0])
            for entry in self._told
            for names in entry.members
            if names and entry.when is not None and self._first(names) is None
        ]

    @functools.cached_property
    def _times(self) -> dict[tuple[str, str], datetime]:
        return {
            (student.id, entry.assignment): entry.when
            for entry in self._told
            for names in entry.members
            if entry.when is not None and (student := self._first(names))
        }


def _of_several(identity: Identity, students: Iterable[Student]) -> str:
    names = ", ".join(student.id for student in students)
    if identity.lms == "moodle":
        return f"{identity} may be {names}: {_with_worksheet(identity.number)}"
    return f"{identity} may be {names}: put the LMS's id of each into students.csv"


def _with_worksheet(number: str) -> str:
    return (
        "collect it together with the grading worksheet (Grades-….csv), which says by their addresses who number "
        f"{number} is"
    )
