"""Finds the student who handed in a file, by its name, by students.csv, and by lists from the LMS.

An explicit statement decides, never likeness: ``--student``, the pattern of ``--names``, a row of
``systems.toml``, or else an id or a name that students.csv has. If two of them say different students, or none of them
says one, the file waits, and the instructor writes the student's id into a cell.

A path on the command line is a download or the work of one student. Each path is the work of one student if one of them
is a file that is neither a zip nor a list, or a zip whose own name says a student; or if there are several and one is a
folder, as with ``repositories/*``. Names inside such a path identify no student. In a download, the names at the top
identify students; and if a single folder at the top contains everything else, the names in that folder, too. Names
further down do not, because students have chosen them.
"""

from __future__ import annotations

import functools
import unicodedata
from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import TYPE_CHECKING

import re2

from autograder.grading.classes.student_folders import reason_against_name
from autograder.grading.collecting.collected_files import Arrival
from autograder.grading.collecting.submitted_file_names import Pattern, read_lms_name, read_plain_name
from autograder.grading.collecting.systems import GRADESCOPE, NAME_FORMS
from autograder.grading.table.roster import Identity, Roster, Student
from autograder.safe_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from autograder.grading.collecting.lms_lists import ListEntry
    from autograder.grading.collecting.submitted_file_names import NameFacts


_WRITE_IT = "write the id under student in collected.csv"
_NUMBERED = ("canvas", "brightspace", "gradescope")
"""The LMSs whose file names contain the number of a person. (Moodle's number is that of a submission.)"""
_LISTED = ("canvas", "github", "gradescope")
"""The LMSs whose lists identify students. (A number from Moodle or Gradescope belongs to one submission only.)"""


@dataclass(frozen=True)
class Owners:
    """The students who handed in a file, according to its name.

    Attributes:
        facts: The facts in the name; None if it has no known form, or the forms of several systems.
        students: The members of the group, or the only student; empty if they are not certain.
        candidates: If they are not certain, the students who may be meant.
        is_sure: True if a number of the LMS identifies the students, and not just a name that students may choose.
        systems: The systems whose form the name has, if they are several: a student has chosen the end of the name.
    """

    facts: NameFacts | None = None
    students: tuple[Student, ...] = ()
    candidates: tuple[Student, ...] = ()
    is_sure: bool = False
    systems: tuple[str, ...] = ()

    @property
    def meant(self) -> tuple[Student, ...]:
        """The students whom the name means, or may mean."""
        return (*self.students, *self.candidates)


class StudentOf:
    """Finds a class's students by the names that the LMSs use for them.

    Args:
        roster: The students of the class.
        form: The LMS that the instructor named for all files; empty to find it from the names.
        names: The pattern given with ``--names``; empty if none was given.
        entries: The entries of all lists, which map numbers to students.
    """

    def __init__(
        self, roster: Roster, form: str = "", names: str = "", entries: Iterable[ListEntry] = ()
    ) -> None:
        self._roster = roster
        self._forms = [form] if form else [one.system for one in NAME_FORMS.values() if not one.needs_from]
        self._names = Pattern(names) if names else None
        self._entries = list(entries)
        self._by_number = {(one.lms, one.number): one for one in self._entries if one.number}
        # Cached, because many files have the same folder in their path.
        self._identified = functools.cache(self._identify)

    def owners(self, arrival: Arrival) -> Owners:
        """Return the students of a file, by the topmost name in its path that has a known form.

        The LMS has chosen the topmost names; the student may have chosen the names below.
        """
        parts = [unicodedata.normalize("NFC", part) for part in arrival.parts]
        if self._names is not None:
            facts = self._names.read(parts, arrival.levels)
            return self._students(facts) if facts else Owners()
        names = [*parts[:-1], PurePath(parts[-1]).stem if arrival.is_alone else ""] if parts else ()
        for place, name in enumerate(names[: arrival.levels]):
            forms = {form: way for form in self._forms if (way := read_lms_name(parts, place, form))}
            if len(forms) > 1:
                return Owners(systems=tuple(forms))
            found = self._students(*(forms.values() or [read_plain_name(name, parts[-1])]))
            if forms or found.meant:
                return found
        return Owners()

    def _students(self, facts: NameFacts) -> Owners:
        """Return the students whom a name means, if all ways to read it that mean students mean the same ones."""
        ways = facts.identities if self._roster.students else facts.identities[:1]
        hits = [(self._identified(one), one) for one in ways]
        hits = [(hit, one) for hit, one in hits if hit.meant]
        if not hits:
            return Owners(facts)
        first, identity = hits[0]
        facts = replace(facts, identities=(identity,))
        rivals = [hit for hit in map(self._identified, facts.rivals) if hit.is_sure]
        read = [*(hit for hit, _ in hits), *rivals]
        if first.students and all(hit.students == first.students for hit in read):
            return replace(first, facts=facts)
        meant = {student.id: student for one in read for student in one.meant}
        return Owners(facts, candidates=tuple(meant.values()))

    def _identify(self, identity: Identity) -> Owners:
        """Return the students whom an identity means, without facts."""
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        if known is not None:
            hits = [hit for names in known.members if (hit := self._first_known(names))]
            hits = [hit for hit in hits if hit[1] or not self._is_another(hit[0], identity)]
            students, are_sure = tuple(one for one, _ in hits), all(is_sure for _, is_sure in hits)
            if hits and len(hits) == len(known.members):
                return Owners(students=students, is_sure=are_sure)
        # Moodle's number in a file name belongs to one submission, so it is not a student's number in students.csv.
        asked = replace(identity, number="") if identity.lms == "moodle" else identity
        found, number = self._roster.find(asked), asked.number.casefold()
        is_sure = bool(found and number) and found[0].lms.get(identity.lms, "").casefold() == number
        found = tuple(one for one in found if is_sure or not self._is_another(one, identity))
        if found and (identity.login or number):
            # A user name in the LMS may equal the id of a different student in the class, so the name has to agree.
            named = self._roster.find(Identity(name=identity.name))
            found = tuple({one.id: one for one in (*found, *(named if len(named) == 1 else ()))}.values())
        called = identity.login or identity.name
        if not self._roster.students and identity.lms and called:
            found = (Student(called),)
        return Owners(students=found, is_sure=is_sure) if len(found) == 1 else Owners(candidates=found)

    def _is_another(self, student: Student, identity: Identity) -> bool:
        """Return True if the student has a different number in that LMS, and so is not the person with this name."""
        theirs = (identity.number if identity.lms != "moodle" else "") or identity.login
        known = self._numbers.get((identity.lms, student.id), set())
        return bool(theirs and known) and theirs.casefold() not in known

    @functools.cached_property
    def _numbers(self) -> dict[tuple[str, str], set[str]]:
        """The numbers or user names that certainly belong to a student, by LMS and student."""
        numbers: dict[tuple[str, str], set[str]] = defaultdict(set)
        for student in self._roster.students.values():
            for lms, number in student.lms.items():
                # Some instructors write user names into the column of an LMS that uses numbers.
                if lms not in _NUMBERED or (number.isdigit() and lms != "gradescope"):
                    numbers[lms, student.id].add(number.casefold())
        for entry in (one for one in self._entries if one.number and one.lms in _LISTED):
            for hit in map(self._first_known, entry.members):
                if hit and hit[1]:
                    numbers[entry.lms, hit[0].id].add(entry.number.casefold())
        return numbers

    def _first_known(self, names: Sequence[Identity]) -> tuple[Student, bool] | None:
        """Return the student whom the first unambiguous identity means, and whether it has a user name or address."""
        hit = self._roster.first(names)
        return hit and (hit[0], bool(names[hit[1]].login))

    def doubt(self, owners: Owners) -> str:
        """Return why it is not certain whose a file is, and what to do; empty if it is certain."""
        for student in owners.students:
            if reason := reason_against_name(student.id):
                return f"{student.id} cannot be a student's id: {reason}. List it in students.csv"
        if owners.students:
            return ""
        if owners.systems:
            forms = " and of ".join(owners.systems)
            return f"the file's name has the form of {forms}: name its system with --from, or {_WRITE_IT}"
        if owners.facts is None:
            return (
                f"the file's name does not identify a student: {_WRITE_IT}, or collect the file alone with --student "
                "ID; if many names have this form, describe it with --names"
            )
        identity, how = owners.facts.identity, _WRITE_IT
        known = self._by_number.get((identity.lms, identity.number or identity.login))
        listed = NAME_FORMS[identity.lms].list if identity.lms in NAME_FORMS and not known else ""
        if listed:
            which = f"{listed}, which maps number {identity.number} to a student"
            how = f"collect the file together with {which}, or {_WRITE_IT}"
        called = f"{identity.login} {identity.name}".strip() or identity.number
        if known:
            called = " and ".join(str(names[-1]) for names in known.members if names) or called
        if owners.candidates:
            return f"{called} may be {', '.join(one.id for one in owners.candidates)}: {how}"
        return f"no student in the class is called {called}: {how}, or add a line to students.csv"

    def written(self, cell: str) -> tuple[tuple[str, ...], str]:
        """Return the ids of the students that a person wrote into a cell, or what is wrong with the cell."""
        ids = []
        for one in filter(None, map(str.strip, cell.replace(",", ";").split(";"))):
            found = self._roster.find(Identity(login=one, name=one))
            if not found:  # a spreadsheet may have dropped the leading zeros of an id, or added a decimal
                number = one.removesuffix(",0").removesuffix(".0")
                found = tuple(
                    other for other in self._roster.students.values() if _same_number(number, other.id)
                )
            if len(found) != 1 and self._roster.students:
                return (), f"students.csv has no student {one}: correct the id under student"
            ids.append(found[0].id if found else one)
            if reason := reason_against_name(ids[-1]):
                return (), f"{ids[-1]} cannot be a student's id: {reason}: correct the id under student"
        return tuple(ids), ""

    def are_of_students(self, paths: Sequence[Path]) -> bool:
        """Return True if the paths of a command are each the work of one student."""
        files = [path for path in paths if not path.is_dir()]
        return any(map(self._is_of_one, files)) or len(files) < len(paths) > 1

    def _is_of_one(self, file: Path) -> bool:
        """Return True for a file that is not a zip, and for a zip whose own name says a student."""
        owners = self.owners(Arrival("", (name_as_text(file.name),)))
        is_of_system = owners.facts is not None and owners.facts.identity.lms in NAME_FORMS
        return bool(file.suffix.lower() != ".zip" or owners.meant or owners.systems or is_of_system)


def _same_number(one: str, other: str) -> bool:
    return bool(one.lstrip("0")) and one.lstrip("0").casefold() == other.lstrip("0").casefold()


_EXPORT = re2.compile(r"^assignment_\d+_export(?: ?\(\d+\)|-\d+)?$")
_SUBMISSION = re2.compile(r"^submission_\d+$")


def levels_of(path: Path, arrivals: Sequence[Arrival], *, is_own: bool) -> int:
    """Return the number of names, from the top of each path, that may identify a student: no student has chosen them.

    Args:
        path: The file or folder that the instructor named.
        arrivals: All files in it, or the file itself.
        is_own: True if all files belong to one student.
    """
    if is_own:
        return 1
    above = 1 if path.is_dir() else 0  # the name of the folder itself
    tops = {one.parts[above : above + 1] for one in arrivals} - {()}
    return above + (2 if len(tops) == 1 else 1)


def is_gradescopes_list(arrival: Arrival, form: str) -> bool:
    """Return True if a file is the list in Gradescope's export, and not a student's file with that name."""
    *above, name = arrival.parts or ("",)
    is_at_top = len(arrival.parts) <= arrival.levels and not any(map(_SUBMISSION.match, above))
    is_export = form == "gradescope" or bool(above and _EXPORT.match(above[-1]))
    return name == GRADESCOPE and is_at_top and is_export
