"""Reads the students of a class from ``students.csv`` and the gradebook, and finds a student by name or number."""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import ClassDirectory, reason_against_name
from autograder.grading.classes.gradebook_reading import has_tables, opened, sql
from autograder.grading.grading_errors import GradingError
from autograder.grading.table.spreadsheet_csv import csv_rows, original

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence


NAME = "students.csv"
LMS = ("canvas", "moodle", "blackboard", "brightspace", "github", "gradescope", "sakai", "ilias")
"""Learning management systems. ``students.csv`` may have a column for each system, with the students' ids or user names
in the system.
"""


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
        section: The section, that is, the group of students that one teaching assistant grades; empty if there is
            none.
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
    """

    def __init__(self, students: Iterable[Student]) -> None:
        self.students = {student.id: student for student in students}

    @property
    def names(self) -> dict[str, str]:
        """The students' names by id; empty for an unknown name."""
        return {student.id: student.name for student in self.students.values()}

    @property
    def excused(self) -> set[tuple[str, str]]:
        """Pairs of a student's id and an assignment from which the student is excused."""
        return {(one.id, assignment) for one in self.students.values() for assignment in one.excused}

    def excused_from_nothing(self, assignments: Sequence[str], students: Iterable[str]) -> list[str]:
        """Return a sentence about each name in the column ``excused`` that is not the name of an assignment.

        Args:
            assignments: The names of all assignments of the class.
            students: The ids of the students to check.
        """
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
        known = {one.section for one in self.students.values()} - {""}
        for section in sections:
            if section not in known:
                raise GradingError(
                    f"No student is in a section named {section}. The sections in {NAME} are: "
                    f"{', '.join(sorted(known)) or 'nothing'}."
                )
        return [one.id for one in self.students.values() if one.section and one.section in set(sections)]

    def find(self, identity: Identity) -> tuple[Student, ...]:
        """Return the students to whom an identity may belong: one if that is certain, otherwise several or none.

        First the number in the LMS decides. If no student has this number, user names and email addresses decide. If
        these match no student either, names decide.
        """
        for known in (self._by_number, self._by_login, self._by_name):
            found = known(identity)
            if found:
                return found
        return ()

    def _by_number(self, identity: Identity) -> tuple[Student, ...]:
        if not identity.number:
            return ()
        return self._all(lambda one: _folded(one.lms.get(identity.lms, "")) == _folded(identity.number))

    def _by_login(self, identity: Identity) -> tuple[Student, ...]:
        if not identity.login:
            return ()
        login = _folded(identity.login)
        exact = self._all(
            lambda one: login in (_folded(one.id), _folded(one.email), _folded(one.lms.get(identity.lms, "")))
        )
        return exact or self._all(lambda one: login == _folded(one.email.partition("@")[0]))

    def _by_name(self, identity: Identity) -> tuple[Student, ...]:
        if words := _words(identity.name):
            forms = _forms(identity.name)
            return self._all(
                lambda one: not forms.isdisjoint(_forms(one.name)) or _words(one.id) == sorted(words)
            )
        login = "".join(_words(identity.login))
        return self._all(lambda one: bool(login) and login in _joined_names(one))

    def _all(self, wanted: Callable[[Student], bool]) -> tuple[Student, ...]:
        return tuple(student for student in self.students.values() if wanted(student))


def read_roster(directory: ClassDirectory) -> Roster:
    """Return the students from ``students.csv`` and from the gradebook. Values in ``students.csv`` take precedence.

    Raises:
        GradingError: The file cannot be used.
    """
    students = {student.id: student for student in _in_gradebook(directory.gradebook_url)}
    for student in read_students_csv(directory):
        known = students.get(student.id, student)
        students[student.id] = replace(
            student,
            first_name=student.first_name or known.first_name,
            last_name=student.last_name or known.last_name,
            email=student.email or known.email,
        )
    return Roster(students.values())


def _in_gradebook(url: str) -> list[Student]:
    with opened(url) as book:
        if not has_tables(book):
            return []
        rows = book.execute(sql("SELECT id, first_name, last_name, email FROM student")).all()
    return [Student(row.id, row.first_name or "", row.last_name or "", row.email or "") for row in rows]


def enter_roster(directory: ClassDirectory) -> None:
    """Enter the students from ``students.csv`` into the gradebook, without changing other students there.

    Raises:
        GradingError: The file cannot be used.
    """
    students = read_students_csv(directory)
    if not students:
        return
    with opened(directory.gradebook_url) as book:
        if not has_tables(book):
            return  # a later step will report that the gradebook is not usable
        known = set(book.execute(sql("SELECT id FROM student")).scalars())
        for student in students:
            values = {
                "id": student.id,
                "first": student.first_name or None,
                "last": student.last_name or None,
                "email": student.email or None,
            }
            if student.id not in known:
                book.execute(sql("INSERT INTO student (id) VALUES (:id)"), {"id": student.id})
            book.execute(
                sql(
                    "UPDATE student SET first_name = COALESCE(:first, first_name),"
                    " last_name = COALESCE(:last, last_name), email = COALESCE(:email, email) WHERE id = :id"
                ),
                values,
            )


_OWN = ("id", "first_name", "last_name", "email", "section", "excused")
_EXPORTED = (
    # For each list from an LMS: the columns that identify the list; and for each column of students.csv, the columns
    # of the list that may contain the value.
    (
        ("student", "id", "section"),  # Canvas: Grades, Export
        {"id": ("sis login id", "sis user id", "id"), "full_name": ("student",), "canvas": ("id",)},
    ),
    (
        ("first name", "email address"),  # Moodle: Participants, Download
        {
            "id": ("id number", "username", "email address"),
            "first_name": ("first name",),
            "last_name": ("last name", "surname"),
            "email": ("email address",),
        },
    ),
    (
        ("sid", "email"),  # Gradescope: Roster, Download
        {
            "id": ("sid", "email"),
            "first_name": ("first name",),
            "last_name": ("last name",),
            "full_name": ("name", "full name"),
            "email": ("email",),
        },
    ),
)
_NOBODY = ("points possible", "student, test")


def read_students_csv(directory: ClassDirectory) -> list[Student]:
    """Return the students from ``students.csv``; none if the file does not exist.

    Raises:
        GradingError: The file cannot be read, the column ``id`` or an id is missing, or an id occurs twice or is
            invalid.
    """
    path = directory.path / NAME
    try:
        header, *rows = csv_rows(path.read_bytes())[0] or [[]]
    except FileNotFoundError:
        return []
    except OSError as error:
        raise GradingError(f"{path} cannot be read: {error}.") from error
    columns = [name.strip().lower() for name in header]
    lines = [
        dict(
            itertools.zip_longest(
                columns, (original(cell).strip() for cell in row[: len(columns)]), fillvalue=""
            )
        )
        for row in rows
    ]
    form = next((form for has, form in _EXPORTED if set(has) <= set(columns)), None)
    if form is not None:
        lines = [_as_ours(line, form) for line in lines]
    elif "id" not in columns:
        raise GradingError(
            f"{path} has no column named id. Its first line has to contain the names of the columns: id and, if you "
            f"have them, {', '.join((*_OWN[1:], *LMS))}. You can also use Canvas's gradebook, Moodle's "
            "participants or Gradescope's roster without changes."
        )
    found: dict[str, Student] = {}
    for line, row in enumerate(lines, 2):
        values = {name: unicodedata.normalize("NFC", cell) for name, cell in row.items()}
        if not any(values.values()):
            continue
        name = values["id"]
        reason = "it has no id" if not name else reason_against_name(name)
        if name in found:
            reason = f"the id {name} also stands in an earlier line"
        if reason:
            raise GradingError(f"{path}, line {line}: {reason}.")
        lms = {column: value for column, value in values.items() if value and column not in _OWN}
        first, last, email = (values.get(column, "") for column in ("first_name", "last_name", "email"))
        excused = values.get("excused", "").replace(",", " ").replace(";", " ").split()
        found[name] = Student(name, first, last, email, lms, tuple(excused), values.get("section", ""))
    return list(found.values())


def _as_ours(line: Mapping[str, str], form: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """Convert a line of an LMS's list to the columns of ``students.csv``; return {} for a line about no person."""
    values = {ours: next(filter(None, map(line.get, theirs)), "") or "" for ours, theirs in form.items()}
    full = values.pop("full_name", "")
    if full.lower().startswith(_NOBODY):
        return {}
    if full:
        last, comma, first = full.partition(",")
        first, last = (first, last) if comma else full.rpartition(" ")[::2]
        values |= {"first_name": first.strip(), "last_name": last.strip()}
    own = {name: line[name] for name in (*LMS, "section", "excused") if line.get(name)}
    return {**values, **own}


def _folded(text: str) -> str:
    return unicodedata.normalize("NFC", text).casefold().strip()


_APOSTROPHES = str.maketrans(dict.fromkeys("'’‘ʼ`´"))


def _forms(name: str) -> set[tuple[str, ...]]:
    """Return the words of a name, sorted, in two forms: O'Brien as the words brien and o, and as the word obrien."""
    return {tuple(sorted(_words(form))) for form in (name, name.translate(_APOSTROPHES))}


def _words(name: str) -> list[str]:
    """Return the words of a name, without accents and in lower case."""
    plain = "".join(
        character for character in unicodedata.normalize("NFKD", name) if not unicodedata.combining(character)
    )
    return "".join(character if character.isalnum() else " " for character in plain.casefold()).split()


def _joined_names(student: Student) -> tuple[str, str]:
    """Return a student's name as one word in two orders, such as "leeann" and "annlee"."""
    first, last = "".join(_words(student.first_name)), "".join(_words(student.last_name))
    return last + first, first + last
