"""Finds the student who handed in a file, by its name, by students.csv, and by lists from the LMS.

A path on the command line is a download or the work of one student. Only the names on the command line decide which of
the two it is, never the contents:

- **The work of one student**: a file or folder with a name that an LMS gives to the work of one student. If the command
  also names a file that is neither a zip nor a list, a path with the name of a student, or several folders, as with
  ``repositories/*``, then each of its paths is the work of one student. Names inside such a path identify no student.
- **A download**: every other zip and folder. The names at its top identify students. If a single folder at the top
  contains everything else, the names in that folder identify students, too. Names further down do not, because students
  have chosen them.
"""

from __future__ import annotations

import functools
import unicodedata
from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import TYPE_CHECKING

import re2

from autograder.grading.classes.class_directory import reason_against_name
from autograder.grading.collecting.download_desk_process import EMPTY
from autograder.grading.collecting.lms_lists import GRADESCOPE
from autograder.grading.collecting.submitted_file_names import (
    TOLD_APART,
    canvas_numbers,
    read_lms_name,
    read_names,
    read_plain_name,
)
from autograder.grading.table.roster import Identity, Roster, Student
from autograder.safe_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from autograder.grading.collecting.collected_files import Arrival
    from autograder.grading.collecting.downloaded_files import File
    from autograder.grading.collecting.lms_lists import ListEntry
    from autograder.grading.collecting.submitted_file_names import NameFacts


_WRITE_IT = "write the id under student in collected.csv"
_NO_ID = f"the file's name does not identify a student: {_WRITE_IT}, or add a line to students.csv"
_LIST_OF = {"moodle": "the grading worksheet (Grades-….csv)", "gradescope": GRADESCOPE}
"""For the LMSs that number submissions instead of students, the list that maps these numbers to students."""
_BY_NUMBER, _BY_LOGIN = ("canvas", "brightspace", "gradescope"), ("blackboard", "sakai", "ilias")
"""The LMSs whose file names contain a person's number, and those whose file names contain a user name."""
_LISTED = ("canvas", "github", "gradescope")
"""The LMSs whose lists identify students. (A number from Moodle or Gradescope belongs to one submission only.)"""


@dataclass(frozen=True)
class Owners:
    """The students who may have handed in a file, according to its name.

    Attributes:
        found: The facts in the name; None if no LMS writes such names, or if several LMSs do, and the students or
            times would differ.
        members: For each member of the group, the students who may be meant; empty if none is known.
        is_sure: True if a number of the LMS identifies the students, and not just a name that students may choose.
    """

    found: NameFacts | None
    members: tuple[tuple[Student, ...], ...] = ()
    is_sure: bool = False


class StudentOf:
    """Finds a class's students by the names that the LMSs use for them.

    Args:
        roster: The students of the class.
        is_notebook: Returns True for the name of a notebook of the class.
        form: The LMS that the instructor named for all files; empty to find it from the names.
        names: The pattern given with ``--names``; empty if none was given.
        entries: The entries of all lists, which map numbers to students.
    """

    def __init__(
        self,
        roster: Roster,
        is_notebook: Callable[[str], bool],
        form: str = "",
        names: str = "",
        entries: Iterable[ListEntry] = (),
    ) -> None:
        self._roster = roster
        self._is_notebook = is_notebook
        self._form = form
        self._names = read_names(names) if names else None
        self._entries = list(entries)
        self._by_number = {(one.lms, one.number): one for one in self._entries if one.number}
        # Cached, because many files have the same folder in their path.
        self._identified = functools.cache(self._identify)

    def owners(self, parts: Sequence[str], levels: int, *, is_alone: bool = False) -> Owners:
        """Return the students of a file, by the topmost name in its path that identifies any student.

        The LMS has chosen the topmost names; the student may have chosen the names below. If a name fits the patterns
        of two LMSs, it must give the same student and time of handing in for both. Otherwise the result has several
        possible students.

        Args:
            parts: The folders of the path and the file.
            levels: The number of names, from the top, that no student has chosen.
            is_alone: True if the instructor named this very file, so that its name may identify the student.
        """
        parts = [unicodedata.normalize("NFC", part) for part in parts]
        if self._names is not None:
            found = self._names(parts, levels)
            hits = [self._identified(one)[0] for one in found.readings] if found else []
            meant = _distinct(students for members in hits for students in members)
            return Owners(found, (meant,) if meant else ())
        forms = [self._form] if self._form else TOLD_APART
        names = [*parts[:-1], PurePath(parts[-1]).stem if is_alone else ""]
        for place in range(min(levels, len(parts))):
            if ways := [
                way for form in forms if (way := read_lms_name(parts, place, form, self._is_notebook))
            ]:
                return self._undisputed(self._agreed(ways), parts[place])
            if owners := self._find(read_plain_name(names[place], parts[-1])):
                return owners
        return Owners(None)

    def written(self, cell: str) -> tuple[tuple[str, ...], str]:
        """Return the ids of the students that a person wrote into a cell, or what is wrong with the cell."""
        ids = []
        for one in filter(None, map(str.strip, cell.replace(",", ";").split(";"))):
            found = self._roster.find(Identity(login=one, name=one))
            if not found:  # a spreadsheet may have dropped the leading zeros of an id, or added a decimal
                number = one.removesuffix(",0").removesuffix(".0").lstrip("0")
                students = self._roster.students.values()
                found = tuple(student for student in students if number and student.id.lstrip("0") == number)
            if len(found) != 1 and self._roster.students:
                return (), f"students.csv has no student {one}: correct the id under student"
            ids.append(found[0].id if found else one)
            if reason := reason_against_name(ids[-1]):
                return (), f"{ids[-1]} cannot be a student's id: {reason}: correct the id under student"
        return tuple(ids), ""

    def paths_of_students(self, paths: Sequence[Path]) -> set[Path]:
        """Return the paths of a command that are each the work of one student."""
        formed = set(filter(self._has_lms_name, paths))
        downloads = {path for path in paths if _DOWNLOAD.match(name_as_text(path.name))}
        others = set(paths) - formed
        if sum(path.is_dir() for path in others) > 1 or any(
            _is_loose(path) or self._is_listed(path) for path in others - downloads
        ):
            return set(paths)
        # A name of a known download means a download. But next to one student's work, a student may have chosen this
        # name, too.
        return formed if formed - downloads else set()

    def note_on(self, source: NamedSource, form: str) -> str:
        """Return a sentence about how a path was interpreted, if its name leaves that open; otherwise an empty text."""
        if not source.files:
            return f"{source.path} {EMPTY}"
        if not source.is_own and not form:
            return (
                f"{source.path} was taken for a download, in which names identify the students: if one student sent "
                "the file, rename it to the student's id"
            )
        if source.is_own and not _is_loose(source.path) and not self._is_listed(source.path):
            return (
                f"{source.path} was taken for one student's work because of its name or the other paths of the "
                "command: if it is a download or a list, rename it to submissions.zip or list.csv, and collect it in "
                "a separate command"
            )
        return ""

    def _has_lms_name(self, path: Path) -> bool:
        """Return True if a file or folder has a name that an LMS gives to the work of one student."""
        owners = self._owners_by_name(path)
        if owners.found is None:
            return bool(owners.members)
        # A user name on GitHub looks like any other name.
        return owners.found.identity.lms not in ("", "github")

    def _is_listed(self, path: Path) -> bool:
        """Return True if a file or folder has the name of a student in the list of students."""
        owners = self._owners_by_name(path)
        return bool(self._roster.students and owners.found and owners.members)

    def _owners_by_name(self, path: Path) -> Owners:
        """Return the students of a file or folder that the instructor named, by its own name alone."""
        name = name_as_text(path.absolute().name)
        return self.owners((name, "") if path.is_dir() else (name,), 1, is_alone=True)

    def _find(self, way: NameFacts) -> Owners | None:
        """Return the students who may be meant, by the first reading of the name that identifies any student."""
        readings = way.readings if self._roster.students and way.readings else (way.identity,)
        for identity in readings:
            members, is_sure = self._identified(identity)
            if members:
                return Owners(replace(way, identity=identity), members, is_sure)
        return None

    def _agreed(self, ways: Sequence[NameFacts]) -> Owners:
        read = [self._find(way) or Owners(way) for way in ways]
        meant = [(one.members, one.members and way.when) for one, way in zip(read, ways, strict=True)]
        if all(one == meant[0] for one in meant):
            return read[0]
        return Owners(None, (_distinct(students for one in read for students in one.members),))

    def _undisputed(self, owners: Owners, name: str) -> Owners:
        """Return ``owners``; but if the name has Canvas numbers of several students, any of these may be meant."""
        if owners.found is None or owners.found.identity.lms != "canvas" or not owners.members:
            return owners
        others = map(self._identified, (Identity("canvas", number) for number in canvas_numbers(name)))
        known = [students for members, is_sure in others if is_sure for students in members]
        meant = _distinct((*owners.members, *known))
        return replace(owners, members=(meant,)) if len(meant) > 1 else owners

    def _identify(self, identity: Identity) -> tuple[tuple[tuple[Student, ...], ...], bool]:
        """Return, for each member of a group, the students who may be meant; and whether a number identifies them."""
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        if known is not None:
            hits = [hit for names in known.members if (hit := self._first_known(names))]
            hits = [hit for hit in hits if hit[1] or not self._is_another(hit[0], identity)]
            if hits and len(hits) == len(known.members):
                return tuple((student,) for student, _ in hits), all(is_sure for _, is_sure in hits)
        # Moodle's number in a file name belongs to one submission, so it is not a student's number in students.csv.
        asked = replace(identity, number="") if identity.lms == "moodle" else identity
        found = self._roster.find(asked)
        number = asked.number.casefold()  # upper and lower case are the same in user names on GitHub
        is_sure = bool(found and number) and found[0].lms.get(identity.lms, "").casefold() == number
        found = tuple(one for one in found if is_sure or not self._is_another(one, identity))
        if found and (identity.login or number):
            # A user name in the LMS may equal the id of a different student in the class, so the name has to
            # agree.
            named = self._roster.find(Identity(name=identity.name))
            found = _distinct((found, named if len(named) == 1 else ()))
        called = identity.login or identity.name
        if not self._roster.students and identity.lms and called:
            found = (Student(called),)
        return ((found,) if found else ()), is_sure

    def _is_another(self, student: Student, identity: Identity) -> bool:
        """Return True if the student has a different number in that LMS, and so is not the person with this name."""
        by_number = identity.number if identity.lms in _BY_NUMBER else ""
        theirs = by_number or (identity.login if identity.lms in _BY_LOGIN else "")
        known = self._numbers.get((identity.lms, student.id), set())
        return bool(theirs and known) and theirs.casefold() not in known

    @functools.cached_property
    def _numbers(self) -> dict[tuple[str, str], set[str]]:
        """The numbers or user names that certainly belong to a student, by LMS and student."""
        numbers: dict[tuple[str, str], set[str]] = defaultdict(set)
        for student in self._roster.students.values():
            for lms, number in student.lms.items():
                # Some instructors write user names into the column of an LMS that uses numbers.
                if lms not in _BY_NUMBER or (number.isdigit() and lms != "gradescope"):
                    numbers[lms, student.id].add(number.casefold())
        for entry in (one for one in self._entries if one.number and one.lms in _LISTED):
            for hit in map(self._first_known, entry.members):
                if hit and hit[1]:
                    numbers[entry.lms, hit[0].id].add(entry.number.casefold())
        return numbers

    def _first_known(self, names: Iterable[Identity]) -> tuple[Student, bool] | None:
        """Return the student whom the first unambiguous identity means, and whether it has a user name or address."""
        hits = ((self._roster.find(name), bool(name.login)) for name in names)
        return next(((found[0], is_sure) for found, is_sure in hits if len(found) == 1), None)

    def reason_against(self, owners: Owners) -> str:
        """Return why a file cannot be assigned to a student, and what to do; empty if it can be assigned."""
        if owners.found is None and owners.members:
            ids = ", ".join(one.id for one in owners.members[0])
            return (
                f"the file's name fits several LMSs, and would mean another student or time in each ({ids}): "
                f"{_WRITE_IT}"
            )
        if owners.found is None:
            return _NO_ID
        identity = owners.found.identity
        number = identity.number or identity.login
        known = self._by_number.get((identity.lms, number))
        what_to_do = _WRITE_IT
        if identity.lms in _LIST_OF and known is None:
            which = f"{_LIST_OF[identity.lms]}, which maps number {number} to a student"
            what_to_do = f"collect the file together with {which}, or {_WRITE_IT}"
        for students in owners.members:
            if len(students) > 1:
                return f"{identity} may be {', '.join(one.id for one in students)}: {what_to_do}"
            if reason := reason_against_name(students[0].id):
                return f"{students[0].id} cannot be a student's id: {reason}. List it in students.csv"
        if owners.members:
            return ""
        called = " and ".join(str(names[-1]) for names in known.members if names) if known else str(identity)
        return f"no student in the class is called {called or number}: {what_to_do}, or add a line to students.csv"


# The names of some downloads look like names of files in Canvas: gradebook_ROS_101_2_2025-10-03-14-05-06.zip, as
# Blackboard makes it, and lab_1_2_submissions.zip.
_DOWNLOAD = re2.compile(r"^(?:gradebook_.*_\d{4}(?:-\d\d){5}(?: ?\(\d+\))?|\D+_\d_\d_[^_]+)\.zip$")


def _is_loose(path: Path) -> bool:
    """Return True if a path is a file that is neither a download nor a list."""
    return path.is_file() and path.suffix.lower() not in (".zip", ".csv")


def _distinct(several: Iterable[Iterable[Student]]) -> tuple[Student, ...]:
    return tuple({one.id: one for students in several for one in students}.values())


_EXPORT = re2.compile(r"^assignment_\d+_export(?: ?\(\d+\)|-\d+)?$")
_SUBMISSION = re2.compile(r"^submission_\d+$")


@dataclass(frozen=True)
class NamedSource:
    """A download, or the files of one student.

    Attributes:
        path: The file or folder that the instructor named.
        files: All files in it, or the file itself.
        is_own: True if all files belong to one student.
    """

    path: Path
    files: tuple[File, ...]
    is_own: bool

    @functools.cached_property
    def levels(self) -> int:
        """The number of names, from the top of each path, that may identify a student: no student has chosen them."""
        if self.is_own:
            return 1
        above = 1 if self.path.is_dir() else 0  # the name of the folder itself, which identifies no student
        return above + (
            2 if len({file.arrival.parts[above : above + 1] for file in self.files} - {()}) == 1 else 1
        )

    def is_list(self, arrival: Arrival, form: str) -> bool:
        """Return True if a file is the list in Gradescope's export, and not a student's file with that name."""
        *above, name = arrival.parts or ("",)
        is_said = (
            name == GRADESCOPE
            and len(arrival.parts) <= self.levels
            and not any(map(_SUBMISSION.match, above))
        )
        return is_said and (form == "gradescope" or bool(above and _EXPORT.match(above[-1])))
