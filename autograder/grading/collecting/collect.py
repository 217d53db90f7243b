"""The command ``collect``: takes files into a class, decides which of them are graded, and shows the result."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder import standard_output
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.archive_unpacking import EMPTY, is_archive
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import SHORT_KEY, Arrival, Delivery, Inbox, LineState
from autograder.grading.collecting.downloaded_files import (
    Archives,
    File,
    NotTaken,
    Room,
    read_list,
    without_sandbox,
)
from autograder.grading.collecting.file_owners import StudentOf, is_gradescopes_list, levels_of
from autograder.grading.collecting.file_to_grade import decide
from autograder.grading.collecting.inbox_lines import lines_of
from autograder.grading.collecting.list_times import NO_LIST, entries_of, in_utc
from autograder.grading.collecting.submitted_file_names import Pattern
from autograder.grading.collecting.submitted_folder import Submitted
from autograder.grading.grading_errors import GradingError, check_known, course_command
from autograder.grading.running.batch_progress import plain_line
from autograder.grading.table.student_list import enter_roster, read_roster
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from datetime import datetime
    from pathlib import Path
    from zoneinfo import ZoneInfo

    from autograder.grading.collecting.collected_files import Line, Place, Receiving
    from autograder.grading.collecting.lms_lists import ListEntry


def collect(
    path: Path,
    sources: Sequence[Path] = (),
    *,
    assignment: str = "",
    zone: ZoneInfo | None = None,
    form: str = "",
    names: str = "",
    handed_in: datetime | None = None,
    student: str = "",
) -> CollectReport:
    """Take files into a class, and apply what a person has written into ``collected.csv``.

    Args:
        path: The class directory.
        sources: Zips, folders, notebooks; and lists from an LMS, which map numbers to students and contain times of
            handing in.
        assignment: The assignment to which all files belong; by default found from names and contents.
        zone: The time zone of times in file names and in lists of an LMS; by default that of the class.
        form: The system from which the files were downloaded, as in ``--from``; by default found from the names.
        names: The pattern of the file names, as in ``--names``.
        student: The id of the student to whom all files belong; by default found from the names.
        handed_in: The time at which all work without a known time was handed in; in ``zone`` if it has no time zone.

    Raises:
        GradingError: The class, the assignment or a file does not exist, or a list cannot be used.
    """
    directory = ClassDirectory(path)
    check_known([assignment] if assignment else [], directory.assignments(), "assignment")
    for source in sources:
        if not source.exists():
            raise GradingError(f"There is no {source}.")
    with directory.lock():
        enter_roster(directory)
        roster = read_roster(directory)
        if student and roster.students:
            check_known([student], list(roster.students), "student")
        columns = {one for known in roster.students.values() for one in known.lms}
        if names:
            Pattern(names).check(sorted(columns | {"github"}))
        when = in_utc(handed_in, zone or directory.time_zone)
        options = Delivery((), form, names, str(zone) if zone else "", assignment, when, student)
        return _Collecting(directory, options).run(sources)


@dataclass(frozen=True)
class CollectReport:
    """The result of collecting.

    Attributes:
        path: The class directory.
        outcomes: The lines of this command's files, of all files that are graded, and of files that wait for a person:
            only those that did not wait before, or all if the command named no file.
        untimed: The students with work collected now whose time of handing in is unknown, by assignment.
        missing: The students who have handed in nothing, by assignment.
        waiting: The number of lines in the table that wait for a person.
        notes: Sentences for the instructor, for example about unclear cells and empty downloads.
        assignments: The assignments for which this command's files are.
        systems: The systems from which this command's files are.
    """

    path: Path
    outcomes: tuple[Line, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    waiting: int = 0
    notes: tuple[str, ...] = ()
    assignments: tuple[str, ...] = ()
    systems: tuple[str, ...] = ()

    def having(self, state: LineState) -> tuple[Line, ...]:
        """Return the lines with this state."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """2 if a person has to decide about one of the files; otherwise 0."""
        return 2 if self.having(LineState.NOT_PLACED) else 0


def show(report: CollectReport) -> None:
    """Print which files were placed and which were not, with the reasons."""
    console = standard_output.console()
    for text in report_lines(report):
        style = "yellow" if text.startswith(LineState.NOT_PLACED) else ""
        plain_line(console, text, style)


def report_lines(report: CollectReport, *, with_waiting: bool = True) -> Iterator[str]:
    """Yield the lines to print, with or without those about files that wait, and about what to type."""
    for one in report.having(LineState.PLACED):
        when = f", handed in {one.when:%Y-%m-%d %H:%M} {one.when.tzinfo}" if one.when else ""
        late = ", late according to the LMS" if one.late else ""
        again = f", {one.reason}" if one.reason else ""
        yield f"placed       {one.student}/{one.assignment}: {one.label}{when}{late}{again}"
    settled = (LineState.UNCHANGED, LineState.EARLIER, LineState.BESIDE, LineState.LEFT_OUT)
    for state in (*settled, LineState.NOT_PLACED) if with_waiting else settled:
        for one in (one for one in report.having(state) if one.reason):
            owner = f"{one.student}: " if one.student else ""
            is_beside = owner and state == LineState.BESIDE
            also = "; the student's notebook was collected, too" if is_beside else ""
            yield f"{state:<12} {one.label}: {owner}{one.reason}{also}"
    for title, absent in (("nothing of", report.missing), ("no time", report.untimed)):
        for assignment, students in absent.items():
            yield f"{title:<12} {assignment}: {', '.join(students)}"
    if untimed := {student for students in report.untimed.values() for student in students}:
        marked = any(one.late and one.student in untimed for one in report.outcomes)
        yield (
            "note         for these students, the time of handing in is unknown"
            + (", though the LMS marks some of them as late" if marked else "")
            + ", so they have no late penalty: write the time under handed_in in collected.csv"
        )
    for note in report.notes:
        yield f"note         {note}"
    counts = {state: len(report.having(state)) for state in LineState}
    yield ", ".join(f"{count} {state}" for state, count in counts.items())
    if not with_waiting:
        return
    if counts[LineState.NOT_PLACED]:
        yield (
            f"note         {counted(report.waiting, 'line')} of {report.path / 'collected.csv'} to decide: write the "
            f"student or the assignment there, or yes or no under use; then type "
            f"{course_command('collect', report.path)}. "
            "If many names have the same form, --from or --names can describe it"
        )
    if counts[LineState.PLACED]:
        yield f"Then         {course_command('grade', report.path)}"


class _Collecting:
    def __init__(self, directory: ClassDirectory, options: Delivery) -> None:
        self._directory = directory
        self._options = options
        self._roster = read_roster(directory)
        self._inbox = Inbox(directory.state)
        self._submitted = Submitted(directory, self._inbox)
        self._table = Table(directory)
        self._notes: list[str] = []
        self._entries: list[ListEntry] = []
        self._rooms: dict[object, Room] = defaultdict(Room)

    def run(self, sources: Sequence[Path]) -> CollectReport:
        """Take files into the inbox, decide about all files in it, and update ``submitted`` and the table."""
        edits, self._notes = self._table.take_edits(self._inbox.keys)
        self._submitted.take_in()
        delivery = self._receive(sources)
        before = {one.label for one in self._table.waiting()}
        lines = decide(lines_of(self._directory, self._inbox, self._roster, edits), self._submitted)
        results = self._submitted.bring(lines)
        lines = [
            replace(one, state=LineState.NOT_PLACED, reason=results[one.place][1])
            if one.state == LineState.PLACED and results[one.place][0] == LineState.NOT_PLACED
            else one
            for one in lines
        ]
        self._table.write(lines, edits)
        return self._report(delivery, lines, results, before)

    def _receive(self, paths: Sequence[Path]) -> Delivery:
        """Keep the files of this command in the inbox, as one delivery, and return the delivery."""
        options = self._options
        with self._inbox.receiving() as receiving, Archives(self._directory.state) as archives:
            lists = [path for path in paths if path.suffix.lower() == ".csv" and path.is_file()]
            others = [path for path in paths if path not in lists]
            is_own = bool(options.student) or self._knowing().are_of_students(others)
            if is_own:  # next to a student's own file, a list may come from a student, too, so it is not read as a list
                lists = []
            arrivals = [self._list(file, receiving) for path in lists for file in archives.files_of(path)]
            student_of = self._knowing()
            for path in (path for path in paths if path not in lists):
                files = tuple(archives.files_of(path, is_opened=not is_own))
                levels = levels_of(path, [file.arrival for file in files], is_own=is_own)
                for file in files:
                    arrivals += self._arrivals(file, levels, student_of, receiving, archives)
                self._notes += [] if files else [f"{path} {EMPTY}"]
            if why := without_sandbox():
                self._notes.append(
                    f"archives and lists were read without a sandbox, only with limits on memory and time: {why}"
                )
            unique = {(one.label, one.key): one for one in arrivals}
            ordered = tuple(one for _, one in sorted(unique.items()))
            assignment = options.assignment or (self._only_assignment() if len(lists) == len(paths) else "")
            receiving.delivery = replace(options, arrivals=ordered, assignment=assignment)
        return receiving.delivery

    def _only_assignment(self) -> str:
        """Return the only assignment of which the students in this command's lists have work so far; else empty."""
        numbers = {(entry.lms, entry.number) for entry in self._entries}
        lines = self._table.lines()
        assignments = {one["assignment"] for one in lines if (one["system"], one["number"]) in numbers}
        return assignments.pop() if len(assignments) == 1 else ""

    def _knowing(self) -> StudentOf:
        """Return a ``StudentOf`` that knows students.csv, the lists in the inbox, and the lists of this command."""
        known = [entry for entries in entries_of(self._inbox).values() for entry in entries]
        return StudentOf(self._roster, self._options.form, self._options.names, [*known, *self._entries])

    def _list(self, file: File, receiving: Receiving) -> Arrival:
        arrival, data = _taken(file, receiving)
        entries = None if arrival.refused else read_list(arrival.name, data)
        if entries is None:
            return replace(arrival, refused=arrival.refused or NO_LIST)
        self._entries += entries
        return replace(arrival, is_list=True)

    def _arrivals(
        self, file: File, levels: int, student_of: StudentOf, receiving: Receiving, archives: Archives
    ) -> Iterator[Arrival]:
        file = file._replace(arrival=replace(file.arrival, levels=levels))
        if is_gradescopes_list(file.arrival, self._options.form):
            yield self._list(file, receiving)
            return
        arrival, data = _taken(file, receiving)
        if arrival.refused or not is_archive(arrival.name, data):
            yield arrival
            return
        yield replace(arrival, is_archive=True)
        whose = tuple(one.id for one in student_of.owners(arrival).meant) or arrival.parts[:2]
        for inner in archives.within(arrival, data, self._rooms[whose]):
            yield _taken(inner, receiving)[0]

    def _report(
        self,
        delivery: Delivery,
        lines: Sequence[Line],
        results: Mapping[Place, tuple[LineState, str]],
        before: Collection[str],
    ) -> CollectReport:
        zone, keys = self._directory.time_zone, {one.key for one in delivery.arrivals}
        contents = {one.content for one in delivery.arrivals}
        counting = [one for one in lines if one.state == LineState.PLACED]
        outcomes = []
        for one in lines:
            also = ""
            if one.state == LineState.PLACED:
                state, reason = results[one.place]
                also = one.reason if one.content in contents else ""
                one = replace(one, state=state, reason=", ".join(filter(None, (reason, also))))
            waits = one.state == LineState.NOT_PLACED and (
                not keys or f"{one.label} {one.key[:SHORT_KEY]}" not in before
            )
            if one.key in keys or one.state == LineState.PLACED or waits or also:
                outcomes.append(replace(one, when=one.when and one.when.astimezone(zone)))
        new = [one for one in counting if one.key in keys]
        here = {one.assignment for one in (new if keys else counting)}
        settled = {one.key for one in self._directory.submissions()[0]}
        settled |= self._roster.excused
        waiting = [one for one in lines if one.state == LineState.NOT_PLACED]
        settled |= {(student, one.assignment) for one in waiting for student in one.students}
        missing = {
            name: tuple(ids)
            for name in sorted(here)
            if (ids := sorted(id_ for id_ in self._roster.students if (id_, name) not in settled))
        }
        untimed = {
            name: tuple(sorted({one.student for one in new if not one.when and one.assignment == name}))
            for name in sorted({one.assignment for one in new if not one.when})
        }
        delivered = [one for one in lines if one.key in keys and one.students and one.assignment]
        notes = [*self._notes, *self._groups_in_part(lines), *self._directory.named_cells.notes]
        notes += self._roster.notices(self._directory.assignments(), {}, self._roster.students)
        if not self._roster.students:
            notes.append(
                "the class has no students.csv, so students' folders have the names that the LMS uses"
            )
        return CollectReport(
            self._directory.path,
            tuple(sorted(outcomes, key=lambda one: one.label)),
            untimed,
            missing,
            len(waiting),
            tuple(notes),
            tuple(sorted({one.assignment for one in delivered})),
            tuple(sorted({one.lms for one in delivered} - {""})),
        )

    def _groups_in_part(self, lines: Sequence[Line]) -> Iterator[str]:
        """Yield a sentence about each group in a list that handed in, but not with a file for each member."""
        groups: dict[str, list[ListEntry]] = defaultdict(list)
        for entry in self._entries:
            if entry.group and entry.when:
                groups[entry.group].append(entry)
        there = {(one.lms, one.number) for one in lines if one.students}
        for name, entries in groups.items():
            without = [str(one.members[0][-1]) for one in entries if (one.lms, one.number) not in there]
            if 0 < len(without) < len(entries):
                yield (
                    f"the group {name} has handed in, but there is no file of {', '.join(without)}: if the file of "
                    "another member is theirs, too, write all ids with ; between them under student in collected.csv"
                )


def _taken(file: File, receiving: Receiving) -> tuple[Arrival, bytes]:
    """Store the bytes of a file in the inbox, and return the file's arrival and the bytes.

    If the file cannot be read, the arrival contains the reason, and the bytes are empty.
    """
    try:
        data = file.read()
    except NotTaken as error:
        return replace(file.arrival, refused=str(error)), b""
    return replace(file.arrival, content=receiving.keep(data)), data
