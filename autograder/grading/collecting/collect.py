"""Putting what was downloaded into ``submitted``: whose it is, for which assignment, and which of several counts."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, reason_against_name
from autograder.grading.collecting.archives import File, NotPlaced, NotTaken, files_of, within
from autograder.grading.collecting.forms import FORMS, base_and_number, plain, read_path
from autograder.grading.collecting.lists import read_list
from autograder.grading.collecting.placing import Candidate, Placed, Placing
from autograder.grading.collecting.which import Which
from autograder.grading.collecting.whose import Whose
from autograder.grading.errors import GradingError, clear_disk_errors
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes
from autograder.grading.table.roster import Roster, enter_roster, read_roster

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import tzinfo
    from pathlib import Path

    from autograder.grading.collecting.which import Target


@dataclass(frozen=True)
class CollectReport:
    """What came of collecting.

    Attributes:
        path: The class.
        placed: What was put into ``submitted``.
        unchanged: How many lay there already.
        older: What is older than what lies there, with the reason.
        others: Notebooks for other assignments than the one that was asked for.
        unread_times: Times in names that nobody could read.
        not_placed: What could not be placed, with the reason.
        left_out: How many files were no notebooks: pages that the LMS adds, pictures and the like.
        missing: Students of whom nothing is there, by assignment.
        by_their_names: Whether there is no list of students, so that folders have the LMS's names.
    """

    path: Path
    placed: tuple[Placed, ...] = ()
    unchanged: int = 0
    older: tuple[NotPlaced, ...] = ()
    others: tuple[NotPlaced, ...] = ()
    unread_times: tuple[str, ...] = ()
    not_placed: tuple[NotPlaced, ...] = ()
    left_out: int = 0
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    by_their_names: bool = False

    @property
    def exit_code(self) -> int:
        """0 when everything has its place; 2 when somebody has to look."""
        return 2 if self.not_placed else 0


def collect(
    path: Path,
    sources: Sequence[Path],
    *,
    assignment: str = "",
    zone: tzinfo | None = None,
    form: str = "",
) -> CollectReport:
    """Put what was downloaded from an LMS into a class.

    Args:
        path: The class directory.
        sources: Zips, folders, notebooks, and lists that say who a number is.
        assignment: What all of it is for; told from names and contents by default.
        zone: The time zone of times in names and lists; this machine's by default.
        form: Which LMS it is from, one of :data:`FORMS`; told from the names by default.

    Raises:
        GradingError: There is no such class, assignment or file, or the list of students cannot be used.
    """
    directory = ClassDirectory(path)
    known = directory.assignments()
    if assignment and assignment not in known:
        raise GradingError(
            f"There is no assignment named {assignment} here. There is: {', '.join(known) or 'none'}."
        )
    for source in sources:
        if not source.exists():
            raise GradingError(f"There is no {source}.")
    with directory.lock(), clear_disk_errors(directory.path):
        enter_roster(directory)
        collecting = _Collecting(directory, assignment, zone, form)
        collecting.read(sources)
        collecting.place()
        return collecting.report()


class _Collecting:
    def __init__(self, directory: ClassDirectory, assignment: str, zone: tzinfo | None, form: str) -> None:
        self._directory = directory
        self._assignment = assignment
        self._zone = zone
        self._form = form
        self._roster: Roster = read_roster(directory)
        self._whose = Whose(self._roster)
        self._which = Which(directory)
        self._placing = Placing(directory)
        self._candidates: list[Candidate] = []
        self._others: list[NotPlaced] = []
        self._left_out = 0

    def read(self, sources: Sequence[Path]) -> None:
        """Read everything that is there and find out what it is."""
        for source in sources:
            if source.suffix.lower() == ".csv":
                self._take_list(source)
        for source in sources:
            if source.suffix.lower() != ".csv":
                self._take(source)

    def place(self) -> None:
        """Put the newest of each student and notebook into ``submitted``."""
        groups: dict[tuple[str, str, str], list[Candidate]] = defaultdict(list)
        for candidate in self._candidates:
            groups[candidate.assignment, candidate.student, candidate.notebook].append(candidate)
        for key in sorted(groups):
            newest = self._placing.newest(self._asked_for(groups[key]))
            if newest is not None:
                self._placing.put(newest)

    def _asked_for(self, group: list[Candidate]) -> list[Candidate]:
        """Without the notebooks for other assignments that came along, as in a zip of the whole course."""
        told = [candidate for candidate in group if candidate.is_told]
        if not told:
            return group
        self._others += [
            NotPlaced(one.file.label, f"it is not for {one.assignment}, and {told[0].file.name} is")
            for one in group
            if not one.is_told
        ]
        return told

    def report(self) -> CollectReport:
        """What came of it."""
        unread = (one.found.time for one in self._candidates if one.found.time and one.found.when is None)
        there = {(one.student, one.assignment) for one in self._directory.submissions()[0]}
        assignments = sorted({one.assignment for one in self._candidates})
        missing = {
            name: tuple(sorted(id_ for id_ in self._roster.students if (id_, name) not in there))
            for name in assignments
        }
        return CollectReport(
            self._directory.path,
            tuple(self._placing.placed),
            self._placing.unchanged,
            tuple(self._placing.older),
            tuple(self._others),
            tuple(dict.fromkeys(unread)),
            tuple(self._placing.not_placed),
            self._left_out,
            {name: students for name, students in missing.items() if students},
            not self._roster.students,
        )

    def _take_list(self, source: Path) -> None:
        try:
            found = read_list(read_bytes(source))
        except UnreadableSubmission as error:
            self._placing.refuse(source.name, str(error))
            return
        if found is None:
            self._placing.refuse(
                source.name,
                "it is none of the lists that are known: Moodle's grading worksheet, Canvas's gradebook, GitHub "
                f"Classroom's grades. A list of your students belongs into {self._directory.path / 'students.csv'}",
            )
        else:
            self._whose.learn(found)

    def _take(self, source: Path) -> None:
        files: list[File] = []
        for file in files_of(source):
            if isinstance(file, NotPlaced):
                self._placing.not_placed.append(file)
            elif file.name.lower().endswith((SUFFIX, ".zip")):
                files.append(file)
            else:
                self._left_out += 1
        # Folders deeper than what all have in common are the students' own: their names say nothing.
        depth = 2 if len({file.parts[0] for file in files}) == 1 else 1
        form = self._form or self._likely_form(files, depth)
        for file in files:
            if not file.name.lower().endswith(".zip"):
                self._take_file(file, form, depth)
                continue
            for inner in within(file):
                if isinstance(inner, NotPlaced):
                    self._placing.not_placed.append(inner)
                elif inner.name.lower().endswith(SUFFIX):
                    self._take_file(inner, form, depth)
                else:
                    self._left_out += 1

    def _likely_form(self, files: Sequence[File], depth: int) -> str:
        """The form that most of the names have; empty where as many lie in folders that are called as students are.

        A student chooses the names of files in such a folder, and might choose one that another system would give
        to somebody else's.
        """
        counts: Counter[str] = Counter()
        for file in files:
            for form in FORMS:
                if read_path(file.parts, form, self._which.is_notebook) is not None:
                    counts[form] += 1
                    break
        likely = max(FORMS, key=lambda form: counts[form]) if counts else ""
        in_folders = sum(any(map(self._whose.find, plain(file.parts)[:depth])) for file in files)
        return likely if counts[likely] > in_folders else ""

    def _take_file(self, file: File, form: str, depth: int) -> None:
        found = read_path(file.parts, form, self._which.is_notebook) if form else None
        ways = [found] if found else plain(file.parts)[:depth]
        chosen = next((who for way in ways if (who := self._whose.find(way)) is not None), None)
        if chosen is None:
            self._placing.refuse(file.label, self._whose.reason_against(found.identity if found else None))
            return
        way, students = chosen
        if len(students) > 1:
            names = ", ".join(student.id for student in students)
            self._placing.refuse(
                file.label, f"{way.identity} may be {names}: put the LMS's id of each into students.csv"
            )
            return
        reason = reason_against_name(students[0].id)
        if reason:
            self._placing.refuse(
                file.label, f"{students[0].id} cannot be a student's id: {reason}. List it in students.csv"
            )
            return
        try:
            data = file.read()
        except NotTaken as error:
            self._placing.refuse(file.label, str(error))
            return
        # Of what lies in a student's own zip the name says which notebook it is, though not whose.
        name = file.name if file.inner else way.file
        stem, number = base_and_number(name[: -len(SUFFIX)] if name.lower().endswith(SUFFIX) else name)
        told = self._which.told(stem, data)
        target = self._target(told)
        if target is None:
            known = ", ".join(self._directory.assignments())
            self._placing.refuse(
                file.label,
                f"it is not clear which assignment it is for (the class has: {known}): say --assignment NAME",
            )
            return
        when = self._in_utc(way.when or self._whose.time_in_list(way.identity))
        self._candidates.append(
            Candidate(
                file,
                way,
                students[0].id,
                *target,
                data,
                when,
                (way.order, number),
                told == target,
            )
        )

    def _target(self, told: Target | None) -> Target | None:
        """Which notebook a file counts as: where the instructor names the assignment, one of that."""
        if self._assignment and (told is None or told[0] != self._assignment):
            notebooks = self._directory.notebooks(self._assignment)
            return (self._assignment, notebooks[0]) if len(notebooks) == 1 else None
        return told

    def _in_utc(self, when: datetime | None) -> datetime | None:
        if when is None:
            return None
        if when.tzinfo is None:
            when = when.replace(tzinfo=self._zone) if self._zone else when.astimezone()
        return when.astimezone(UTC)
