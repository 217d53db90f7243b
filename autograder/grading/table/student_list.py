"""The students of a class, and the changes by a new list: a student is dropped, joins, or gets another id.

The class remembers the list that it used last, in ``.autograder/students.json``. A student is the same person as before
if an LMS has the same number for both. If the lists contain no numbers, an equal id or address decides.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.gradebook_reading import has_tables, opened, sql
from autograder.grading.grading_errors import GradingError, course_command
from autograder.grading.table.roster import NAME, Roster, Student, folded, name_forms
from autograder.grading.table.students_csv import StudentsFile, read_students_csv
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from autograder.grading.classes.class_directory import ClassDirectory

_REMEMBERED = "students.json"
RENAMING = "renaming.json"
"""The file in the class's state folder that exists while students get other ids."""


class KnownStudents(msgspec.Struct, frozen=True):
    """The students whom a class knows, by id.

    Attributes:
        listed: The students of the list that was used last.
        former: Students who were listed earlier, or who are only in the gradebook.
    """

    listed: dict[str, Student] = {}
    former: dict[str, Student] = {}


@dataclass(frozen=True)
class ListChanges:
    """What a list of students changes in a class.

    Attributes:
        renamed: The new ids by the old ones. A new id that is not in the list is that of a former student, whose id
            belongs to another person now.
        unclear: Pairs of a known and a new id whose students have the same name, and may be one person.
        dropped: The ids that are no longer listed.
        added: The new ids.
        moved: The ids of students whose section has changed, each with the old and the new section.
        renumbered: The ids of students who have the same name, or the same address, but another number in an LMS, each
            with the old and the new number.
    """

    renamed: Mapping[str, str] = field(default_factory=dict)
    unclear: tuple[tuple[str, str], ...] = ()
    dropped: tuple[str, ...] = ()
    added: tuple[str, ...] = ()
    moved: tuple[tuple[str, str, str], ...] = ()
    renumbered: tuple[tuple[str, str, str], ...] = ()

    @property
    def unclear_alone(self) -> dict[str, str]:
        """The pairs of :attr:`unclear` whose two ids are in no other pair: the new ids by the old ones."""
        often = Counter(id_ for pair in self.unclear for id_ in pair)
        return {old: new for old, new in self.unclear if often[old] == often[new] == 1}


def compare(known: KnownStudents, new: Mapping[str, Student], said: Mapping[str, str]) -> ListChanges:
    """Return what a new list changes.

    Args:
        known: The students whom the class knows.
        new: The students of the new list, by id.
        said: New ids by old ones, as the instructor gave them. An id with itself means that the student is the same
            although the numbers differ.
    """
    before = {**known.former, **known.listed}
    renamed = dict(said)
    owners: dict[tuple[str, str], list[str]] = defaultdict(list)
    for student in before.values():
        for number in student.numbers:
            owners[number].append(student.id)
    for student in new.values():
        for old in (old for number in sorted(student.numbers) for old in owners[number] if old != student.id):
            renamed.setdefault(old, student.id)
    for old, student in before.items():
        if old in renamed or old not in new:
            continue
        # If only the number was corrected, the student is still the same person.
        theirs = {owner for number in new[old].numbers for owner in owners[number]} - {old}
        is_other = _differ(student, new[old]) or (theirs and student.name)
        if is_other and not _has_name(student, new[old]) and not _has_address(student, new[old]):
            renamed[old] = _free_id(student, {*before, *new})
    gone = [student for student in before.values() if student.id not in new and student.id not in renamed]
    came = [one for one in new.values() if one.id not in before and one.id not in renamed.values()]
    alike: dict[str, set[str]] = defaultdict(set)
    for student in new.values():
        for text in filter(None, (student.id, student.email)):
            alike[folded(text)].add(student.id)
    for student in gone:
        same = {id_ for text in (student.id, student.email) for id_ in alike.get(folded(text), ())}
        same = {id_ for id_ in same if not _differ(student, new[id_])}
        if len(same) == 1:
            renamed[student.id] = same.pop()
    unclear = [
        (old.id, one.id)
        for old in gone
        for one in came
        if old.id not in renamed and not _differ(old, one) and _has_name(old, one)
    ]
    renamed = {old: now for old, now in renamed.items() if old != now}
    now = {renamed.get(old, old): old for old in known.listed}
    return ListChanges(
        renamed,
        tuple(unclear),
        tuple(old for old in known.listed if renamed.get(old, old) not in new),
        tuple(one for one in new if one not in now),
        tuple(
            (one, known.listed[now[one]].section, student.section)
            for one, student in new.items()
            if one in now and known.listed[now[one]].section not in ("", student.section)
        ),
        tuple(
            (one, f"{lms} {number}", dict(new[one].numbers)[lms])
            for one in new
            if one in now
            for lms, number in sorted(known.listed[now[one]].numbers)
            if dict(new[one].numbers).get(lms, number) != number
        ),
    )


def _differ(one: Student, other: Student) -> bool:
    """Return True if an LMS has different numbers for two students."""
    theirs = dict(other.numbers)
    return any(theirs.get(lms, number) != number for lms, number in one.numbers)


def _has_address(one: Student, other: Student) -> bool:
    return bool(one.email and folded(one.email) == folded(other.email))


def _has_name(one: Student, other: Student) -> bool:
    return bool(one.name) and not name_forms(one.name).isdisjoint(name_forms(other.name))


def _free_id(student: Student, taken: Iterable[str]) -> str:
    """Return an id for a student whose own id now belongs to another person."""
    name = f"{student.id}-{min((number for _, number in student.numbers), default='former')}"
    return name if name not in set(taken) else f"{name}-former"


def read_known(directory: ClassDirectory) -> KnownStudents:
    """Return the students whom a class knows.

    If the class does not remember a list, the students of the gradebook count as listed.
    """
    in_gradebook = _in_gradebook(directory.gradebook_url)
    try:
        data = (directory.state / _REMEMBERED).read_bytes()
        known = msgspec.json.decode(data, type=KnownStudents)
    except (OSError, msgspec.MsgspecError):
        return KnownStudents(in_gradebook)
    others = {id_: one for id_, one in in_gradebook.items() if id_ not in known.listed}
    return KnownStudents(known.listed, {**others, **known.former})


def _in_gradebook(url: str) -> dict[str, Student]:
    with opened(url) as book:
        if not has_tables(book):
            return {}
        rows = book.execute(sql("SELECT id, first_name, last_name, email FROM student")).all()
    return {
        row.id: Student(row.id, row.first_name or "", row.last_name or "", row.email or "") for row in rows
    }


def read_roster(directory: ClassDirectory) -> Roster:
    """Return the students of ``students.csv`` or, if that file lists none, those of the gradebook.

    Raises:
        GradingError: The file cannot be used, or gives another id to a student whom the class knows.
    """
    file = _settled(directory)
    in_gradebook = _in_gradebook(directory.gradebook_url)
    if not file.students:
        return Roster(in_gradebook.values())
    listed, known = {student.id for student in file.students}, read_known(directory)
    former = [one for id_, one in {**known.former, **known.listed}.items() if id_ not in listed]
    students = [_completed(student, in_gradebook.get(student.id, student)) for student in file.students]
    return Roster(students, is_whole=True, former=former, unknown=file.unknown)


def _completed(student: Student, entry: Student) -> Student:
    names = ("first_name", "last_name", "email")
    return replace(student, **{name: getattr(student, name) or getattr(entry, name) for name in names})


def enter_roster(directory: ClassDirectory) -> None:
    """Enter the students of ``students.csv`` into the gradebook, and remember them.

    Raises:
        GradingError: The file cannot be used, or gives another id to a student whom the class knows.
    """
    accept_list(directory, _settled(directory), {})


def _settled(directory: ClassDirectory) -> StudentsFile:
    """Return the content of ``students.csv``.

    Raises:
        GradingError: The file cannot be used, or gives another id to a student whom the class knows.
    """
    to_do = course_command("students", directory.path)
    if (directory.state / RENAMING).exists():
        raise GradingError(f"A change of students' ids was interrupted. To finish it, type {to_do} --yes")
    file = read_students_csv(directory.path / NAME)
    if file.students:
        changes = compare(read_known(directory), {one.id: one for one in file.students}, {})
        if pairs := [*changes.renamed.items(), *changes.unclear]:
            words = ", ".join(f"{old} → {new}" for old, new in pairs)
            raise GradingError(
                f"{directory.path / NAME} seems to give other ids to students whom the class knows: {words}. Nothing "
                f"was done. To see what would change, type {to_do}"
            )
    return file


def accept_list(directory: ClassDirectory, file: StudentsFile, renamed: Mapping[str, str]) -> None:
    """Enter a list of students into the gradebook, without changing other students there, and remember the list.

    Args:
        directory: The class.
        file: The list.
        renamed: The new ids by the old ones, which the gradebook already has.
    """
    if not file.students:
        return
    known = read_known(directory)
    listed = {student.id: student for student in file.students}
    before = {renamed.get(old, old): one for old, one in {**known.former, **known.listed}.items()}
    former = {id_: replace(one, id=id_) for id_, one in before.items() if id_ not in listed}
    data = msgspec.json.encode(KnownStudents(listed, former), order="sorted")
    path = directory.state / _REMEMBERED
    if not path.exists() or path.read_bytes() != data:
        write_whole(path, data)
    with opened(directory.gradebook_url) as book:
        if not has_tables(book):
            return  # a later step will report that the gradebook is not usable
        book.execute(
            sql(
                "INSERT INTO student (id, first_name, last_name, email) VALUES (:id, :first, :last, :email)"
                " ON CONFLICT (id) DO UPDATE SET first_name = COALESCE(excluded.first_name, student.first_name),"
                " last_name = COALESCE(excluded.last_name, student.last_name),"
                " email = COALESCE(excluded.email, student.email)"
            ),
            [
                {
                    "id": one.id,
                    "first": one.first_name or None,
                    "last": one.last_name or None,
                    "email": one.email or None,
                }
                for one in file.students
            ],
        )
