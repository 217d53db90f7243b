"""Takes files into the inbox of a class, decides about each, and changes ``submitted`` accordingly."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.apply import Submitted
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.deciding.assignment_of import AssignmentOf
from autograder.grading.collecting.deciding.decide import Decision, Looks, decide
from autograder.grading.collecting.deciding.proposals import Edit, Proposals, entries_of, in_utc, list_trouble
from autograder.grading.collecting.deciding.student_of import StudentOf
from autograder.grading.collecting.inbox import Arrival, Delivery, Inbox
from autograder.grading.collecting.older_class import take_over
from autograder.grading.collecting.outcomes import CollectReport, Outcome, State
from autograder.grading.collecting.reading.archives import Archives, File, NotTaken, Room
from autograder.grading.collecting.reading.desk import read_list, without_sandbox
from autograder.grading.collecting.reading.named_sources import Source, note_on, own_of, source_of
from autograder.grading.collecting.reading.names_option import check_names
from autograder.grading.collecting.reading.unpack import is_archive
from autograder.grading.errors import GradingError, check_known
from autograder.grading.table.roster import enter_roster, read_roster
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from datetime import datetime
    from pathlib import Path
    from zoneinfo import ZoneInfo

    from autograder.grading.collecting.deciding.decide import Place
    from autograder.grading.collecting.deciding.proposals import Line
    from autograder.grading.collecting.inbox import Receiving
    from autograder.grading.collecting.reading.lists import Entry

_MOST_NAMED = 5


def collect(
    path: Path,
    sources: Sequence[Path] = (),
    *,
    assignment: str = "",
    zone: ZoneInfo | None = None,
    form: str = "",
    names: str = "",
    handed_in: datetime | None = None,
) -> CollectReport:
    """Take files into a class, and apply what a person has written into the class's table.

    Args:
        path: The class directory.
        sources: Zips, folders, notebooks; and lists from an LMS, which map numbers to students and contain times of
            handing in.
        assignment: The assignment to which all files belong; by default found from names and contents.
        zone: The time zone of times in file names and in lists of an LMS; by default that of the class.
        form: The system from which the files were downloaded, as in ``--from``; by default found from the names.
        names: The pattern of the file names, as in ``--names``.
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
        if names:
            check_names(
                names,
                sorted({one for student in read_roster(directory).students.values() for one in student.lms}),
            )
        when = in_utc(handed_in, zone or directory.time_zone)
        options = Delivery((), form, names, str(zone) if zone else "", assignment, when)
        return _Collecting(directory, options).run(sources)


class _Collecting:
    def __init__(self, directory: ClassDirectory, options: Delivery) -> None:
        self._directory = directory
        self._options = options
        self._roster = read_roster(directory)
        self._inbox = Inbox(directory.state)
        self._submitted = Submitted(directory, self._inbox)
        self._table = Table(directory)
        self._notes: list[str] = []
        self._lists: dict[str, list[Entry]] = {}
        self._rooms: dict[object, Room] = defaultdict(Room)

    def run(self, sources: Sequence[Path]) -> CollectReport:
        """Take all files in, decide, and write down the decisions."""
        edits, notes = self._table.read()
        self._notes += take_over(self._directory, self._inbox, edits)
        self._table.put_edits(edits)
        self._submitted.take_in()
        delivery = self._receive(sources)
        decisions, counts = self._decide(edits)
        results = {place: (state, why) for place, state, why in self._submitted.bring(counts, decisions)}
        decisions = [self._with_trouble(one, results) for one in decisions]
        before = {one.label for one in self._table.waiting()}
        self._table.write(decisions, edits)
        return self._report(delivery, decisions, results, [*notes, *self._notes], before)

    def _decide(self, edits: dict[str, Edit]) -> tuple[list[Decision], dict[Place, Line]]:
        lines = Proposals(self._directory, self._inbox, self._roster, edits).lines()
        return decide(lines, Looks(self._directory, self._inbox, self._submitted))

    # -- taking in

    def _receive(self, paths: Sequence[Path]) -> Delivery:
        """Take the named files into the inbox."""
        options = self._options
        with self._inbox.receiving() as receiving, Archives(self._directory.state) as archives:
            student_of = self._knowing([])
            own = own_of(paths, student_of)
            tables = [path for path in paths if path.suffix.lower() == ".csv" and path.is_file()]
            # In Google's names, nothing distinguishes an instructor's list from a student's file.
            lists = [path for path in tables if path not in own and options.form != "google"]
            arrivals = [self._list(file, receiving) for path in lists for file in archives.files_of(path)]
            others = [path for path in paths if path not in lists]
            own = {*own_of(others, self._knowing(self._entries)), *tables}
            sources = [source_of(path, archives, is_own=path in own) for path in others]
            student_of = self._knowing(self._entries)
            for source in sources:
                arrivals += self._source(source, student_of, receiving, archives)
                note = note_on(source, student_of, options.form or options.names)
                self._notes += [note] if note else []
            if why := without_sandbox():
                self._notes.append(
                    f"archives and lists were read without a sandbox, with limits alone: {why}"
                )
            unique = {(one.label, one.key): one for one in arrivals}
            ordered = tuple(one for _, one in sorted(unique.items()))
            receiving.delivery = replace(options, arrivals=ordered)
        return receiving.delivery

    def _knowing(self, entries: Iterable[Entry]) -> StudentOf:
        """Return what is known about students from students.csv, lists in the inbox, and lists in this delivery."""
        options, own = self._options, list(entries)
        known = [entry for entries in entries_of(self._inbox).values() for entry in entries]
        is_notebook = AssignmentOf(self._directory).is_notebook
        return StudentOf(self._roster, is_notebook, options.form, options.names, [*known, *own], own)

    def _list(self, file: File, receiving: Receiving) -> Arrival:
        arrival, data = _taken(_arrival(file, is_list=True), file, receiving)
        if trouble := arrival.refused or list_trouble(file.name, data):
            return replace(arrival, refused=trouble, is_list=False)
        entries = read_list(file.name, data) or []
        self._lists[arrival.content] = entries
        return arrival

    def _source(
        self, source: Source, student_of: StudentOf, receiving: Receiving, archives: Archives
    ) -> Iterator[Arrival]:
        for file in source.files:
            if source.is_list(file, self._options.form):
                yield self._list(file, receiving)
                continue
            arrival, data = _taken(
                _arrival(file, levels=source.levels, is_own=source.is_own), file, receiving
            )
            if not is_archive(file.name, data):
                yield arrival
                continue
            yield replace(arrival, is_archive=True)
            owners = student_of.owners(file.parts, source.levels, is_alone=source.is_own)
            whose = tuple(one.id for members in owners.members for one in members) or file.parts[:2]
            for inner in archives.within(file, data, self._rooms[source.download, whose]):
                yield _taken(replace(arrival, inner=inner.inner, content=""), inner, receiving)[0]

    @property
    def _entries(self) -> list[Entry]:
        """Return the entries of the lists in this delivery."""
        return [entry for entries in self._lists.values() for entry in entries]

    # -- the result

    def _with_trouble(self, one: Decision, results: dict[Place, tuple[State, str]]) -> Decision:
        """Return the decision. If something other than a file is at the place, the decision then waits for a person."""
        state, reason = results.get(one.place, (State.UNCHANGED, ""))
        is_hindered = one.state == State.PLACED and state == State.NOT_PLACED
        return replace(one, state=state, reason=reason) if is_hindered else one

    def _report(
        self,
        delivery: Delivery,
        decisions: list[Decision],
        results: dict[Place, tuple[State, str]],
        notes: list[str],
        before: set[str],
    ) -> CollectReport:
        labels = {one.key: one.label for one in delivery.arrivals}
        outcomes = []
        for one in decisions:
            changed = one.state == State.PLACED == results.get(one.place, (State.UNCHANGED, ""))[0]
            waits = one.state == State.NOT_PLACED and f"{one.line.label} {one.line.key}" not in before
            if one.line.key in labels or changed or waits or (not delivery.arrivals and _waits(one)):
                outcomes.append(self._outcome(one, labels.get(one.line.key, one.line.label), results))
        counting = [one for one in decisions if one.state == State.PLACED]
        here = {one.line.assignment for one in counting if one.line.key in labels or not labels}
        work = {(one.student, one.assignment) for one in self._directory.submissions()[0]}
        not_missing = work | self._roster.excused
        missing = {
            name: tuple(sorted(id_ for id_ in self._roster.students if (id_, name) not in not_missing))
            for name in sorted(here)
        }
        untimed: dict[str, list[str]] = defaultdict(list)
        for one in sorted(counting, key=lambda one: one.student):
            if one.line.when is None and one.line.key in labels:
                untimed[one.line.assignment].append(one.student)
        if several := self._knowing(self._entries).of_several_times:
            notes.append(
                f"lists have several times for {_some(several)}, and nothing says which is of what, so none counts: "
                "collect each assignment in a command of its own, with its list"
            )
        notes += self._roster.excused_from_nothing(self._directory.assignments(), self._roster.students)
        notes += self._directory.named_cells.notes
        if not self._roster.students:
            notes.append("the class has no students.csv: folders have the names that the LMS uses")
        return CollectReport(
            self._directory.path,
            tuple(sorted(outcomes, key=lambda one: one.label)),
            {name: tuple(dict.fromkeys(students)) for name, students in untimed.items()},
            {name: students for name, students in missing.items() if students},
            sum(map(_waits, decisions)),
            tuple(notes),
        )

    def _outcome(self, one: Decision, label: str, results: dict[Place, tuple[State, str]]) -> Outcome:
        line = one.line
        state, why = results.get(one.place, (State.UNCHANGED, ""))
        own = state if one.state == State.PLACED else one.state
        label = label if len(line.students) < 2 or not line.notebook else f"{label} ({one.student})"
        is_replacing = own == State.PLACED and why == "replaced"
        when = line.when and line.when.astimezone(self._directory.time_zone)
        return Outcome(
            label, own, one.reason, one.student, line.assignment, when, line.late, is_replacing, line.key
        )


def _waits(one: Decision) -> bool:
    return one.state == State.NOT_PLACED


def _arrival(file: File, *, levels: int = 1, is_own: bool = False, is_list: bool = False) -> Arrival:
    """Return the arrival of a file whose bytes have not been read yet."""
    source = "" if file.source.is_dir() else name_as_text(file.source.name)
    return Arrival(source, file.parts, file.inner, levels=levels, is_own=is_own, is_list=is_list)


def _taken(arrival: Arrival, file: File, receiving: Receiving) -> tuple[Arrival, bytes]:
    """Return the arrival of a file after reading and keeping its bytes, or with the reason why not; and the bytes."""
    try:
        data = file.read()
    except NotTaken as error:
        return replace(arrival, refused=str(error)), b""
    return replace(arrival, content=receiving.keep(data)), data


def _some(names: Sequence[str]) -> str:
    """Return the first few of these names as text."""
    return ", ".join(names[:_MOST_NAMED]) + (" …" if names[_MOST_NAMED:] else "")
