"""Finds a file's student by comparing its name with the list of students and with the lists in the download."""

from __future__ import annotations

import functools
import unicodedata
from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import reason_against_name
from autograder.grading.collecting.reading.lists import GRADESCOPE
from autograder.grading.collecting.reading.lms_file_names import TOLD_APART, numbers_in, plain, read_at
from autograder.grading.collecting.reading.names_option import read_names
from autograder.grading.table.roster import Identity, Roster, Student
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from datetime import datetime
    from pathlib import Path

    from autograder.grading.collecting.reading.lists import Entry
    from autograder.grading.collecting.reading.lms_file_names import Found

_WRITE_IT = "write the id under student in collected.csv"
_NO_ID = f"its name does not say whose it is: {_WRITE_IT}, or add a line to students.csv"
_LIST_OF = {"moodle": "the grading worksheet (Grades-….csv)", "gradescope": GRADESCOPE}
"""For each system that gives a student a new number in every submission, the list that maps the numbers to students."""
_NOBODY = Identity()
_BY_NUMBER, _BY_LOGIN = ("canvas", "brightspace"), ("github", "blackboard", "google", "sakai", "ilias")
"""The systems whose names contain a person's number, and those whose names contain a user name. Both stay the same for
all assignments.
"""
_LISTED = ("canvas", "github", "gradescope")
"""The systems whose lists identify students. (A number from Moodle or Gradescope belongs to one submission only.)"""


@dataclass(frozen=True)
class Owners:
    """The students who may have handed in a file, according to its name.

    Attributes:
        found: The facts in the name; None if its form is unknown, or if several systems may have made the name, and
            would mean different students or times by it.
        members: For each member of the group, the students who may be meant; empty if none is known.
        is_sure: True if a number of the system identifies the students, and not just a name that students may choose.
    """

    found: Found | None
    members: tuple[tuple[Student, ...], ...] = ()
    is_sure: bool = False


class StudentOf:
    """Finds a class's students by the names that the systems use for them.

    Args:
        roster: The students of the class.
        is_notebook: Returns True for the name of a notebook of the class.
        form: The system that the instructor named for all files; empty to find it from the names.
        names: The pattern given with ``--names``; empty if none was given.
        entries: The entries of all lists, which map numbers to students.
        own: The entries of lists that came with the files. Their times apply to the files.
        others: The entries of lists that came alone. Their times are used if those in ``own`` have none.
    """

    def __init__(
        self,
        roster: Roster,
        is_notebook: Callable[[str], bool],
        form: str = "",
        names: str = "",
        entries: Iterable[Entry] = (),
        own: Iterable[Entry] = (),
        others: Iterable[Entry] = (),
    ) -> None:
        self._roster = roster
        self._is_notebook = is_notebook
        self._form = form
        self._names = read_names(names) if names else None
        self._entries = list(entries)
        self._timed = (_times(own), _times(others))
        self._by_number = {(one.lms, one.number): one for one in self._entries if one.number}
        self._of = functools.cache(self._who)  # cached, because many files are in the same folder

    def owners(self, parts: Sequence[str], levels: int, *, is_alone: bool = False) -> Owners:
        """Return the students of a file, found by the topmost name in its path that identifies any.

        Whatever name a student gives a file, the system's own part of the path is above that name or before it. If
        two systems may have made a name, both must mean the same student by it; "no match" counts as a disagreement.

        Args:
            parts: The folders of the path and the file.
            levels: The number of names, from the top, that no student has chosen.
            is_alone: True if the instructor named this very file, so that its name may identify the student.
        """
        parts = [unicodedata.normalize("NFC", part) for part in parts]
        if self._names is not None:
            found = self._names(parts)
            hits = [self._of(one)[0] for one in found.readings] if found else []
            meant = _distinct(students for members in hits for students in members)
            return Owners(found, (meant,) if meant else ())
        forms = [self._form] if self._form else TOLD_APART
        names = [*parts[:-1], PurePath(parts[-1]).stem if is_alone and self._form != "google" else ""]
        # In a download from Google Classroom, students may have chosen the name of any folder, however deep.
        for place in range(len(parts) if self._form == "google" else min(levels, len(parts))):
            if ways := [way for form in forms if (way := read_at(parts, place, form, self._is_notebook))]:
                return self._undisputed(self._agreed(ways), parts[place])
            if place < levels and (owners := self.find(plain(names[place], parts[-1]))):
                return owners
        return Owners(None)

    def has_form(self, path: Path) -> bool:
        """Return True if a file or folder has a name of the kind that a system makes for one student's work."""
        owners = self._of_name(path)
        if owners.found is None:
            return bool(owners.members)
        # Names from these systems have no part by which they could be recognized.
        return owners.found.identity.lms not in ("", "google", "github")

    def is_called(self, path: Path) -> bool:
        """Return True if a file or folder has the name of a student in the list of students."""
        owners = self._of_name(path)
        return bool(self._roster.students and owners.found and owners.members)

    def _of_name(self, path: Path) -> Owners:
        name = name_as_text(path.absolute().name)
        return self.owners((name, "") if path.is_dir() else (name,), 1, is_alone=True)

    def find(self, way: Found) -> Owners | None:
        """Return the students who may be meant, by the first reading of the name that identifies any student."""
        readings = way.readings if self._roster.students and way.readings else (way.identity,)
        for identity in readings:
            members, is_sure = self._of(identity)
            if members:
                return Owners(replace(way, identity=identity), members, is_sure)
        return None

    def _agreed(self, ways: Sequence[Found]) -> Owners:
        read = [self.find(way) or Owners(way) for way in ways]
        meant = [(one.members, one.members and way.when) for one, way in zip(read, ways, strict=True)]
        if all(one == meant[0] for one in meant):
            return read[0]
        return Owners(None, (_distinct(students for one in read for students in one.members),))

    def _undisputed(self, owners: Owners, name: str) -> Owners:
        """Return ``owners``; if a name may be another student's Canvas number, all students with these numbers."""
        if owners.found is None or owners.found.identity.lms != "canvas" or not owners.members:
            return owners
        others = map(self._of, (Identity("canvas", number) for number in numbers_in(name)))
        known = [students for members, is_sure in others if is_sure for students in members]
        meant = _distinct((*owners.members, *known))
        return replace(owners, members=(meant,)) if len(meant) > 1 else owners

    def _who(self, identity: Identity) -> tuple[tuple[tuple[Student, ...], ...], bool]:
        """Return the students who may be meant, and whether that is certain. Without a list, use the LMS's name."""
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        if known is not None:
            hits = [hit for names in known.members if (hit := self._first(names))]
            hits = [hit for hit in hits if hit[1] or not self._is_another(hit[0], identity)]
            if hits and len(hits) == len(known.members):
                return tuple((student,) for student, _ in hits), all(is_sure for _, is_sure in hits)
        # students.csv may have a different Moodle number; the number in the name belongs to one student in one
        # assignment.
        asked = replace(identity, number="") if identity.lms == "moodle" else identity
        found = self._roster.find(asked)
        number = asked.number.casefold()  # case does not matter in GitHub's user names
        is_sure = bool(found and number) and found[0].lms.get(identity.lms, "").casefold() == number
        found = tuple(one for one in found if is_sure or not self._is_another(one, identity))
        if found and (identity.login or number):
            # A user name in the system may equal the id of a different student in the class, so the name has to
            # agree.
            named = self._roster.find(Identity(name=identity.name))
            found = _distinct((found, named if len(named) == 1 else ()))
        called = identity.login or identity.name
        if not self._roster.students and identity.lms and called:
            found = (Student(called),)
        return ((found,) if found else ()), is_sure

    def _is_another(self, student: Student, identity: Identity) -> bool:
        """Return True if the student has a different number in that system, and so is not the person with this name."""
        lms = identity.lms
        by_number = lms in (*_BY_NUMBER, "gradescope")
        theirs = (by_number and identity.number) or (lms in _BY_LOGIN and identity.login) or ""
        known = {
            student.lms.get(lms, "") if lms != "gradescope" else "",
            *self._listed.get((lms, student.id), ()),
        }
        # The column of a system that uses numbers may contain a user name.
        known = {one.casefold() for one in known if one and (one.isdigit() or lms not in _BY_NUMBER)}
        return bool(theirs and known) and theirs.casefold() not in known

    @functools.cached_property
    def _listed(self) -> dict[tuple[str, str], set[str]]:
        """Return the numbers by which lists identify students with certainty, by system and student id."""
        numbers: dict[tuple[str, str], set[str]] = defaultdict(set)
        entries = (
            (entry, names) for entry in self._entries if entry.lms in _LISTED for names in entry.members
        )
        hits = ((entry, self._first(names)) for entry, names in entries if entry.number)
        for entry, hit in hits:
            if hit and hit[1]:
                numbers[entry.lms, hit[0].id].add(entry.number)
        return numbers

    def _first(self, names: Iterable[Identity]) -> tuple[Student, bool] | None:
        """Return the student of the first identity that only one student has, and whether it is more than a name."""
        hits = ((self._roster.find(name), bool(name.login)) for name in names)
        return next(((found[0], is_sure) for found, is_sure in hits if len(found) == 1), None)

    def reason_against(self, owners: Owners) -> str:
        """Return why a file cannot be assigned to a student, and what to do; empty if it can be assigned."""
        if owners.found is None and owners.members:
            ids = ", ".join(one.id for one in owners.members[0])
            return f"its name fits several systems, which mean different students or times by it ({ids}): {_WRITE_IT}"
        if owners.found is None:
            return _NO_ID if self._roster.students else f"{_NO_ID}, which the class does not have"
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
        is_listed = identity.lms in _LIST_OF and known is None
        what_to_do = _with_list(identity) if is_listed else f"{_WRITE_IT}, or add a line to students.csv"
        return f"no student in the class is called {called or number}: {what_to_do}"

    def time(self, identity: Identity) -> datetime | None:
        """Return the time of handing in that the lists have for this number; None if they have none, or several."""
        number = (identity.lms, identity.number or identity.login)
        times = next((known[number] for known in self._timed if number in known), set())
        return next(iter(times)) if len(times) == 1 else None

    @property
    def of_several_times(self) -> list[str]:
        """Return the numbers for which the lists have several times, so that none of these counts."""
        return sorted({number for (_, number), times in self._timed[0].items() if len(times) > 1})


def _distinct(several: Iterable[Iterable[Student]]) -> tuple[Student, ...]:
    """Return all these students, each once."""
    return tuple({one.id: one for students in several for one in students}.values())


def _times(entries: Iterable[Entry]) -> dict[tuple[str, str], set[datetime]]:
    times: dict[tuple[str, str], set[datetime]] = defaultdict(set)
    for one in entries:
        if one.when is not None and one.number:
            times[one.lms, one.number].add(one.when)
    return dict(times)


def _of_several(identity: Identity, students: Iterable[Student]) -> str:
    names = ", ".join(student.id for student in students)
    return f"{identity} may be {names}: {_with_list(identity) if identity.lms in _LIST_OF else _WRITE_IT}"


def _with_list(identity: Identity) -> str:
    who = f"which says who number {identity.number} is"
    return f"collect it together with {_LIST_OF[identity.lms]}, {who}, or {_WRITE_IT}"
