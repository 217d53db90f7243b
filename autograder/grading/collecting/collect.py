"""Puts a download into ``submitted``: finds the student and the assignment of each file, and the file that counts."""

from __future__ import annotations

import zlib
from collections import defaultdict
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.archives import File, NotTaken, Room, files_of, is_zip, within
from autograder.grading.collecting.assignment_of import AssignmentOf, NoTarget, is_notebook, stem_of
from autograder.grading.collecting.lists import GRADESCOPE, LARGEST_OF_GRADESCOPE, Entry, is_unread, read_list
from autograder.grading.collecting.named_sources import Source, note_on, own_of, source_of
from autograder.grading.collecting.outcomes import CollectReport, Outcome, State, WaitingList
from autograder.grading.collecting.records import Collected, CollectedRecords
from autograder.grading.collecting.student_of import Owners, StudentOf
from autograder.grading.collecting.submitted_files import Candidate, Placing
from autograder.grading.errors import GradingError, check_known, course_command
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes
from autograder.grading.table.roster import Roster, enter_roster, read_roster

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import tzinfo
    from pathlib import Path

    from autograder.grading.collecting.forms import Found

_PAGES = ("index.html", GRADESCOPE)
"""Files that an LMS itself adds to a download."""
_NOBODY = Owners(None)
_MOST_NAMED = 5
_CAME = (State.PLACED, State.UNCHANGED, State.EARLIER)
_OTHER_ARCHIVES = (".rar", ".7z", ".gz", ".tgz", ".tar", ".bz2", ".xz", ".zst")


def collect(
    path: Path,
    sources: Sequence[Path],
    *,
    assignment: str = "",
    zone: tzinfo | None = None,
    form: str = "",
    times: Sequence[Path] = (),
    handed_in: datetime | None = None,
) -> CollectReport:
    """Put what was downloaded from an LMS into a class.

    Args:
        path: The class directory.
        sources: Zips, folders, notebooks, and lists that say who a number is.
        assignment: The assignment that all of it is for; told from names and contents by default.
        zone: The time zone of times in names and lists; the time zone of the class by default.
        form: The LMS that it is from, as in ``--from``; told from the names by default.
        times: Lists of times; they count for all work of the students in them, also for work that was collected before.
        handed_in: The time of all work for which nothing else says one; in ``zone`` where it has no zone.

    Raises:
        GradingError: There is no such class, assignment or file, or a list cannot be used.
    """
    directory = ClassDirectory(path)
    check_known([assignment] if assignment else [], directory.assignments(), "assignment")
    for source in (*sources, *times):
        if not source.exists():
            raise GradingError(f"There is no {source}.")
    with directory.lock():
        enter_roster(directory)
        collecting = _Collecting(directory, assignment, zone or directory.time_zone, form, handed_in)
        return collecting.run(sources, times)


def settle(path: Path, labels: Sequence[str]) -> list[str]:
    """Forget files that have no place and need none, and give back the names that are not known.

    Raises:
        GradingError: There is no such class.
    """
    directory = ClassDirectory(path)
    with directory.lock():
        return WaitingList(directory).settle(labels)


class _Collecting:
    def __init__(
        self,
        directory: ClassDirectory,
        assignment: str,
        zone: tzinfo,
        form: str,
        handed_in: datetime | None,
    ) -> None:
        self._directory = directory
        self._assignment = assignment
        self._zone = zone
        self._form = form
        self._handed_in = self._in_utc(handed_in)
        self._roster: Roster = read_roster(directory)
        self._assignment_from = AssignmentOf(directory, assignment)
        self._student_of = self._knowing([], [])
        self._candidates: list[Candidate] = []
        self._outcomes: list[Outcome] = []
        self._unread: list[str] = []
        self._rooms: dict[tuple[Path, tuple[str, ...]], Room] = defaultdict(Room)

    def run(self, sources: Sequence[Path], times: Sequence[Path]) -> CollectReport:
        """Read everything that is there, put it in its place, and write down what has none."""
        read = self._learn(sources, times)
        for source in read:
            self._take(source)
        placing = Placing(self._directory)
        self._outcomes += placing.place(self._candidates)
        work = {(one.student, one.assignment) for one in self._directory.submissions()[0]}
        notes = self._note_times(placing, sorted(key for key in work if self._assignment in ("", key[1])))
        notes += [
            f"{name} is in the list of times, and nobody is called so" for name in self._student_of.strangers
        ]
        if several := self._student_of.of_several_times:
            notes.append(
                f"lists have several times for {_some(several)}, and nothing says which is of what, so none counts: "
                "collect each assignment in a command of its own, with its list"
            )
        notes += self._roster.excused_from_nothing(self._directory.assignments(), self._roster.students)
        notes += self._assignment_from.notes
        notes += [note for one in read if (note := note_on(one, self._student_of, self._form))]
        came = {(one.student, one.assignment) for one in self._outcomes if one.state in _CAME}
        came |= {(student, "") for student, _ in came}
        self._outcomes = [
            _alone(one)
            if one.state == State.BESIDE and one.student and (one.student, one.assignment) not in came
            else one
            for one in self._outcomes
        ]
        WaitingList(self._directory).note(self._outcomes)
        return self._report(work, notes)

    def _note_times(self, placing: Placing, work: Sequence[tuple[str, str]]) -> list[str]:
        """Write down what lists say of work that is there, and give back a sentence on each time, new or left out.

        An entry without an assignment may be meant for the one that is collected now: another's known time stays.
        """
        records = CollectedRecords(self._directory.state)
        here = {(one.student, one.assignment) for one in self._candidates}
        is_clear = bool(self._assignment) or len(self._directory.assignments()) == 1
        told, kept = [], defaultdict(list)
        for student, name in work:
            when = self._in_utc(self._student_of.time(student, name))
            known = history.when if (history := records.get(name, student)) else None
            is_meant = is_clear or (student, name) in here or self._student_of.has_time_of(student, name)
            if when is not None and (is_meant or known is None):
                told.append((student, name, when))
            elif when not in (None, known):
                kept[name].append(student)
        noted = placing.note_times(told)
        notes = [f"{student}/{name} was handed in {when:%Y-%m-%d %H:%M} UTC" for student, name, when in noted]
        return notes + [
            f"the list of times names no assignment, so the times that are known of {name} stay ({_some(students)}): "
            f"where it is about {name}, say --assignment {name}"
            for name, students in kept.items()
        ]

    def _report(self, work: set[tuple[str, str]], notes: Sequence[str]) -> CollectReport:
        records = CollectedRecords(self._directory.state)
        untimed = defaultdict(list)
        for student, assignment in sorted({(one.student, one.assignment) for one in self._candidates}):
            history = records.get(assignment, student)
            if history is not None and history.when is None:
                untimed[assignment].append(student)
        assignments = sorted({one.assignment for one in self._candidates})
        not_missing = work | self._roster.excused
        missing = {
            name: tuple(sorted(id_ for id_ in self._roster.students if (id_, name) not in not_missing))
            for name in assignments
        }
        return CollectReport(
            self._directory.path,
            tuple(self._outcomes),
            tuple(dict.fromkeys(self._unread)),
            {name: tuple(students) for name, students in untimed.items()},
            {name: students for name, students in missing.items() if students},
            not self._roster.students,
            tuple(notes),
        )

    def _learn(self, paths: Sequence[Path], times: Sequence[Path]) -> list[Source]:
        """Read the lists, those that were named and the one of Gradescope's export; give back all else."""
        own = own_of(paths, self._student_of)
        tables = [path for path in paths if path.suffix.lower() == ".csv" and path.is_file()]
        # In Google's names nothing tells a list of the instructor's from a student's.
        lists = [path for path in tables if path not in own and self._form != "google"]
        entries = [entry for path in lists for file in files_of(path) for entry in self._entries(file)]
        told = [one for one in entries if not one.lms]
        for path in times:
            try:
                found = read_list(path.name, read_bytes(path))
            except UnreadableSubmission as error:
                raise GradingError(f"{path} cannot be read: {error}") from error
            if found is None or not any(one.when for one in found):
                raise GradingError(
                    f"{path} says of nobody when work was handed in. Its first line has to name the columns id and "
                    "handed_in, and assignment where it is about several; or it is a list of the LMS's own."
                )
            told += found
        self._student_of = self._knowing(entries, told)
        others = [path for path in paths if path not in lists]
        own = {*own_of(others, self._student_of), *tables}
        sources = [source_of(path, is_own=path in own) for path in others]
        for source in sources:
            for file in source.files:
                if source.is_list(file, self._form):
                    entries += self._entries(file)
        self._unread += [one.time for one in (*entries, *told) if is_unread(one)]
        self._student_of = self._knowing(entries, told)
        return sources

    def _knowing(self, entries: list[Entry], told: list[Entry]) -> StudentOf:
        """Who is who, by the roster and by lists."""
        return StudentOf(self._roster, self._assignment_from.is_notebook, self._form, entries, told)

    def _entries(self, file: File) -> list[Entry]:
        try:
            data = file.read()
            if file.name == GRADESCOPE and len(data) > LARGEST_OF_GRADESCOPE:
                raise NotTaken(f"Gradescope's list may have {LARGEST_OF_GRADESCOPE / 1e6:.0f} MB")
            found = read_list(file.name, data)
        except NotTaken as error:
            self._refuse(file, str(error))
            return []
        if found is None:
            self._refuse(
                file,
                "it is none of the lists that are known: Moodle's grading worksheet, Canvas's gradebook or its "
                "submissions, GitHub Classroom's grades, Gradescope's scores, or one with the columns id and "
                "handed_in. "
                f"A list of your students belongs into {self._directory.path / 'students.csv'}",
            )
        else:
            self._outcomes.append(Outcome(file.label, State.BESIDE, "it was read as a list"))
        return found or []

    def _take(self, source: Source) -> None:
        levels = source.levels
        for file in source.files:
            if source.is_list(file, self._form):
                continue
            owners = self._student_of.owners(file.parts, levels, is_alone=source.is_own)
            try:
                data = file.read()
            except NotTaken as error:
                self._not_taken(file, str(error), owners)
                continue
            if not is_zip(file.name, data):
                self._take_file(file.holding(data), data, owners, source.download)
            elif reason := self._student_of.reason_against(owners):
                self._refuse(file.holding(data), reason, owners)
            else:
                ids = tuple(one.id for students in owners.members for one in students)
                for inner, held in within(file, data, self._rooms[source.download, ids]):
                    if isinstance(held, NotTaken):
                        self._not_taken(inner, str(held), owners)
                    else:
                        self._take_file(inner.holding(held), held, owners, source.download)

    def _not_taken(self, file: File, reason: str, owners: Owners) -> None:
        """Say why a file cannot be read."""
        if is_notebook(file.name, b"") or is_zip(file.name, b""):
            self._refuse(file, reason, owners)
        else:
            self._outcomes.append(self._soft(file, reason, owners))

    def _take_file(self, file: File, data: bytes, owners: Owners, download: Path) -> None:
        """Take a file, or say why not."""
        if not is_notebook(file.name, data):
            self._outcomes.append(self._no_notebook(file, owners))
            return
        found, reason = owners.found, self._student_of.reason_against(owners)
        if found is None or reason:
            self._refuse(file, reason, owners)
        else:
            self._take_notebook(file, data, owners, found, download)

    def _take_notebook(self, file: File, data: bytes, owners: Owners, found: Found, download: Path) -> None:
        """Note a notebook for each of its students, or say why it is for no assignment."""
        # Of what is in a student's own zip the name says which notebook it is, though not whose.
        name = file.name if file.inner else found.file
        packed, identity = zlib.compress(data, 1), found.identity
        for (student,) in owners.members:
            try:
                (assignment, notebook), is_named = self._assignment_from.target(name, data)
            except NoTarget as error:
                self._outcomes.append(self._without_target(file, error, Owners(found, ((student,),))))
                continue
            if found.time and found.when is None:
                self._unread.append(found.time)
            collected = Collected(
                notebook,
                file.content,
                source=file.label if len(owners.members) == 1 else f"{file.label} ({student.id})",
                collected=datetime.now(tz=UTC),
                when=self._when(found, student.id, assignment),
                order=found.order,
                late=found.late,
                lms=identity.lms,
                number=identity.number,
                name=identity.name or identity.login,
                file="/".join(file.parts),
            )
            number = stem_of(name)[1]
            self._candidates.append(
                Candidate(
                    student.id,
                    assignment,
                    collected,
                    found,
                    download,
                    packed,
                    number,
                    is_named,
                    owners.is_sure,
                )
            )

    def _when(self, way: Found, student: str, assignment: str) -> datetime | None:
        when = way.when or self._student_of.time(student, assignment, way.identity)
        return self._in_utc(when) or self._handed_in

    def _without_target(self, file: File, error: NoTarget, owners: Owners) -> Outcome:
        """The outcome of a notebook without a place: it may be work, whatever else of its student's has come."""
        if error.is_left_out:
            return self._soft(file, str(error), owners)
        if error.assignment:
            return replace(self._soft(file, str(error), owners), assignment=error.assignment)
        return self._outcome(file, State.NOT_PLACED, str(error), owners)

    def _no_notebook(self, file: File, owners: Owners) -> Outcome:
        """The outcome of a file that holds no notebook: a picture, a page of the LMS, or the work in another form."""
        if file.name in _PAGES and not file.inner and not owners.members:
            return Outcome(file.label, State.BESIDE, "it is a page of the LMS")
        student = owners.only
        name = student.id if student else "STUDENT"
        if file.name.lower().endswith(_OTHER_ARCHIVES):
            reason = (
                f"it is an archive that is not opened here: unpack it into a folder named {name}, and type "
                f"{course_command('collect', self._directory.path, name)}"
            )
            return self._outcome(file, State.NOT_PLACED, reason, owners)
        place = (
            self._directory.path / "submitted" / name / (self._assignment_of(file, owners) or "ASSIGNMENT")
        )
        return self._soft(file, "it is no notebook", owners, f"ask for the notebook, or put it into {place}")

    def _refuse(self, file: File, reason: str, owners: Owners = _NOBODY) -> None:
        self._outcomes.append(self._outcome(file, State.NOT_PLACED, reason, owners))

    def _soft(self, file: File, reason: str, owners: Owners, what_to_do: str = "") -> Outcome:
        """An outcome that somebody has to look at, unless its student's notebook has come, too."""
        outcome = replace(self._outcome(file, State.BESIDE, reason, owners), what_to_do=what_to_do)
        return outcome if outcome.student else _alone(outcome)

    def _outcome(self, file: File, state: State, reason: str, owners: Owners) -> Outcome:
        student = owners.only.id if owners.only else ""
        assignment = self._assignment_of(file, owners)
        return Outcome(file.label, state, reason, student, assignment, content=file.content)

    def _assignment_of(self, file: File, owners: Owners) -> str:
        """The assignment that a file's name, as the student gave it, speaks of."""
        own_name = owners.found.file if owners.found and owners.members and not file.inner else file.name
        return self._assignment_from.named(own_name)

    def _in_utc(self, when: datetime | None) -> datetime | None:
        if when is None:
            return None
        try:
            return (when if when.tzinfo else when.replace(tzinfo=self._zone)).astimezone(UTC)
        except (OverflowError, ValueError):
            return None  # the year 1 or 9999, beyond which a zone leads


def _some(names: Sequence[str]) -> str:
    """The first of these names."""
    return ", ".join(names[:_MOST_NAMED]) + (" …" if names[_MOST_NAMED:] else "")


def _alone(one: Outcome) -> Outcome:
    """The outcome of a file that came without its student's notebook of that assignment: it needs a place."""
    reason = f"{one.reason}: {one.what_to_do}" if one.what_to_do else one.reason
    return replace(one, state=State.NOT_PLACED, reason=reason)
