"""The students of a class, found by a number, a user name or a name."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import re2

from autograder.grading.grading_errors import check_known
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.grading.classes.gradebook_reading import Entries


NAME = "students.csv"
LMS = ("canvas", "moodle", "blackboard", "brightspace", "github", "gradescope", "sakai", "ilias")
"""Learning management systems. ``students.csv`` may have a column for each system, with the students' ids or user names
in the system.
"""
COLUMNS = ("id", "first_name", "last_name", "email", "section", "excused", *LMS)
"""The columns of ``students.csv`` that have a meaning. Only ``id`` is needed."""


@dataclass(frozen=True)
class Student:
    """A student of the class.

    Attributes:
        id: The student's id, which is also the name of the student's folder.
        first_name: The first name; empty if unknown.
        last_name: The last name; empty if unknown.
        email: The email address; empty if unknown.
        lms: The student's ids and user names in learning management systems, by the names in :data:`LMS`; and the
            content of other columns, which ``collect --names`` may use.
        excused: The assignments from which the student is excused.
        section: The section, that is, the group of students that one teaching assistant grades; or several sections,
            as Canvas joins them; empty if there is none.
    """

    id: str
    first_name: str = ""
    last_name: str = ""
    email: str = ""
    lms: Mapping[str, str] = field(default_factory=dict)
    excused: tuple[str, ...] = ()
    section: str = ""

    @property
    def name(self) -> str:
        """The first and last name, in one text; empty if both are unknown."""
        return f"{self.first_name} {self.last_name}".strip()

    @property
    def sections(self) -> set[str]:
        """The sections: the whole text, and the parts that Canvas or Moodle joined, as in ``Mon, Tue, and Lab``."""
        parts = _JOINED.split(self.section)
        return {self.section, *map(str.strip, parts)} - {""}

    @property
    def numbers(self) -> set[tuple[str, str]]:
        """Pairs of an LMS and the number or name by which this LMS alone knows the student."""
        # A group may share an account on GitHub.
        return {(name, folded(self.lms[name])) for name in LMS if name in self.lms and name != "github"}


_JOINED = re2.compile(r",? and |, ")


@dataclass(frozen=True)
class Identity:
    """What a file name or a line of an LMS's list says about a person.

    Attributes:
        lms: The system, one of :data:`LMS`; empty if the system is unknown.
        number: The number by which the system knows the student.
        login: A user name, an email address, or a name without spaces.
        name: A name as people write it.
    """

    lms: str = ""
    number: str = ""
    login: str = ""
    name: str = ""

    def __str__(self) -> str:
        return self.name or self.login or self.number


_MOST_NAMED = 5


class Roster:
    """The students of a class.

    Args:
        students: The students, in any order.
        is_whole: True if no other student is in the class, because the students are those of ``students.csv``.
        former: Students who are not in the class any more. Their files are still recognized.
        unknown: The names of columns of ``students.csv`` that have no meaning.
    """

    def __init__(
        self,
        students: Iterable[Student],
        *,
        is_whole: bool = False,
        former: Iterable[Student] = (),
        unknown: Sequence[str] = (),
    ) -> None:
        self.students = {student.id: student for student in students}
        self._is_whole = is_whole
        self._former = tuple(former)
        self._unknown = unknown

    def has(self, student: str) -> bool:
        """Return True if a student belongs to the class: ``students.csv`` lists this id, or lists no student."""
        return not self._is_whole or student in self.students

    def members(self, others: Iterable[str]) -> list[str]:
        """Return the ids of the students of the class, sorted.

        Args:
            others: The ids under which work was handed in. They are left out if ``students.csv`` does not list them.
        """
        return sorted({*self.students, *filter(self.has, others)})

    def notices(self, assignments: Sequence[str], entries: Entries, students: Iterable[str]) -> list[str]:
        """Return sentences about probable mistakes in ``students.csv``, and about points of students it does not list.

        Args:
            assignments: The names of all assignments of the class.
            entries: The entries of the gradebook.
            students: The ids of the students whose entries in the column ``excused`` are checked.
        """
        others: dict[str, list[str]] = {}
        for (student, assignment), entry in sorted(entries.items()):
            if not self.has(student):
                others.setdefault(student, []).append(f"{assignment} {entry.points:g}")
        found = self._excused_from_nothing(assignments, students)
        if self._unknown:
            found.append(
                f"{NAME} has columns whose names have no meaning, except in collect --names: "
                f"{', '.join(self._unknown)}. The known ones are {', '.join(COLUMNS)}"
            )
        if others:
            points = "; ".join(f"{student} ({', '.join(of)})" for student, of in others.items())
            found.append(
                f"{NAME} does not list these students, so their points are in no table and no export: {points}. The "
                "points stay in the gradebook, and count again once the student is listed"
            )
        return found

    @property
    def names(self) -> dict[str, str]:
        """The students' names by id; empty for an unknown name."""
        return {student.id: student.name for student in self.students.values()}

    @property
    def excused(self) -> set[tuple[str, str]]:
        """Pairs of a student's id and an assignment from which the student is excused."""
        return {(one.id, assignment) for one in self.students.values() for assignment in one.excused}

    def _excused_from_nothing(self, assignments: Sequence[str], students: Iterable[str]) -> list[str]:
        """Return a sentence about each name in the column ``excused`` that is not the name of an assignment."""
        found: dict[str, list[str]] = {}
        for one in map(self.students.__getitem__, students):
            for name in one.excused:
                if name not in assignments:
                    found.setdefault(name, []).append(one.id)
        return [
            f"{NAME} excuses {', '.join(ids[:_MOST_NAMED])}{' …' if ids[_MOST_NAMED:] else ''} from {name}, "
            f"but this assignment does not exist, so the entry excuses no student. "
            f"The class has: {', '.join(assignments)}"
            for name, ids in found.items()
        ]

    def of_sections(self, sections: Iterable[str]) -> list[str]:
        """Return the ids of the students in some sections.

        Raises:
            GradingError: A section has no students.
        """
        known = {section for one in self.students.values() for section in one.sections}
        check_known(list(sections), sorted(known), f"section in {NAME}")
        return [one.id for one in self.students.values() if one.sections & set(sections)]

    def left_out(self, sections: Sequence[str]) -> list[str]:
        """Return a sentence about the students who are in none of some sections; no sentence if there are no such."""
        others = [one for one in self.students.values() if not one.sections & set(sections)]
        counts = Counter(section for one in others for section in one.sections if not _JOINED.search(section))
        if not sections or not others:
            return []
        of_section = [f"{count} of {section}" for section, count in sorted(counts.items())]
        without = [one.id for one in others if not one.section]
        named = (
            f"without a section: {', '.join(without[:_MOST_NAMED])}{' …' if without[_MOST_NAMED:] else ''}"
        )
        parts = "; ".join([*of_section, *([named] if without else [])])
        return [f"--section leaves out {counted(len(others), 'student')} ({parts})"]

    def find(self, identity: Identity) -> tuple[Student, ...]:
        """Return the students to whom an identity may belong: one if that is certain, otherwise several or none.

        First the number in the LMS decides. If no student has this number, user names and email addresses decide. If
        these match no student either, names decide.
        """
        ways = (self._by_number, self._by_login, self._by_name)
        return next(filter(None, (way(identity) for way in ways)), ())

    def first(self, identities: Iterable[Identity]) -> tuple[Student, int] | None:
        """Return the student whom the first unambiguous identity means, and the index of that identity."""
        found = ((self.find(identity), place) for place, identity in enumerate(identities))
        return next(((students[0], place) for students, place in found if len(students) == 1), None)

    def _by_number(self, identity: Identity) -> tuple[Student, ...]:
        if not identity.number:
            return ()
        return self._all(lambda one: folded(one.lms.get(identity.lms, "")) == folded(identity.number))

    def _by_login(self, identity: Identity) -> tuple[Student, ...]:
        if not identity.login:
            return ()
        login = folded(identity.login)
        exact = self._all(
            lambda one: login in (folded(one.id), folded(one.email), folded(one.lms.get(identity.lms, "")))
        )
        return exact or self._all(lambda one: login == folded(one.email.partition("@")[0]))

    def _by_name(self, identity: Identity) -> tuple[Student, ...]:
        if words := _words(identity.name):
            forms = name_forms(identity.name)
            return self._all(
                lambda one: not forms.isdisjoint(name_forms(one.name)) or _words(one.id) == sorted(words)
            )
        login = "".join(_words(identity.login))
        return self._all(lambda one: bool(login) and login in _joined_names(one))

    def _all(self, wanted: Callable[[Student], bool]) -> tuple[Student, ...]:
        return tuple(filter(wanted, self.students.values())) or tuple(filter(wanted, self._former))


def folded(text: str) -> str:
    """Return a text so that upper and lower case, and the forms of an accent, make no difference."""
    return unicodedata.normalize("NFC", text).casefold().strip()


_APOSTROPHES = str.maketrans(dict.fromkeys("'’‘ʼ`´"))


def name_forms(name: str) -> set[tuple[str, ...]]:
    """Return the words of a name, sorted, in two forms: O'Brien as the words brien and o, and as the word obrien."""
    return {tuple(sorted(_words(form))) for form in (name, name.translate(_APOSTROPHES))}


def _words(name: str) -> list[str]:
    """Return the words of a name, without accents, in lower case, and with i for the Turkish ı, whose capital is I."""
    plain = "".join(
        character for character in unicodedata.normalize("NFKD", name) if not unicodedata.combining(character)
    )
    return "".join(
        character if character.isalnum() else " " for character in plain.casefold().replace("ı", "i")
    ).split()


def _joined_names(student: Student) -> tuple[str, str]:
    """Return a student's name as one word in two orders, such as "leeann" and "annlee"."""
    first, last = "".join(_words(student.first_name)), "".join(_words(student.last_name))
    return last + first, first + last
