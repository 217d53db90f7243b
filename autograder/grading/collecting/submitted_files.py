"""The choice of the file that counts, and its way into ``submitted`` so that nothing is lost."""

from __future__ import annotations

import hashlib
import zlib
from collections import defaultdict
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory
from autograder.grading.classes.timestamps import TIMESTAMP, timestamp_text
from autograder.grading.collecting.handed_out import HandedOut
from autograder.grading.collecting.outcomes import Outcome, State
from autograder.grading.collecting.records import Collected, CollectedRecords, History, repository_of
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes, why_unreadable
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from autograder.grading.collecting.forms import Found
    from autograder.grading.table.roster import Identity

    _Others = list[tuple["Candidate", Outcome]]
    """The files that do not count, and what became of them."""


_ONE_NUMBER = ("canvas", "moodle", "brightspace")
"""The systems that give a person one number in a download, and in which people may change their names."""


@dataclass(frozen=True)
class Candidate:
    """A file whose student and notebook are known.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        collected: The record of it, if it counts.
        found: The facts in its name.
        download: The file or folder that it came in, or its own where it was named alone: files of one download that
            have the same time were handed in together.
        packed: Its bytes, compressed: all files of a download are held at once, and a few bytes of a student's archive
            may unpack to gigabytes.
        number: The number that a browser or a system has added to its name.
        is_named: Whether it is called as the notebook is.
        is_sure: Whether the system's number says whose it is, and not a name that students may choose.
        has_work: Whether it has more than what was handed out; only looked into where another one may count.
    """

    student: str
    assignment: str
    collected: Collected
    found: Found
    download: Path
    packed: bytes
    number: int
    is_named: bool
    is_sure: bool
    has_work: bool = True

    @property
    def data(self) -> bytes:
        """Its bytes."""
        return zlib.decompress(self.packed)

    @property
    def content(self) -> str:
        """The hash of its bytes."""
        return self.collected.content

    @property
    def label(self) -> str:
        """Its name in messages."""
        return self.collected.source

    def outcome(self, state: State, reason: str = "", *, replaced: bool = False) -> Outcome:
        """Its outcome."""
        when, late = self.collected.when, self.collected.late
        return Outcome(
            self.label,
            state,
            reason,
            self.student,
            self.assignment,
            when,
            late,
            replaced,
            content=self.content,
        )


class Placing:
    """Puts notebooks into a class and gives the outcome of each.

    Args:
        directory: The class, locked by this process.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._records = CollectedRecords(directory.state)
        self._handed_out = HandedOut(directory)

    def place(self, candidates: Iterable[Candidate]) -> Iterator[Outcome]:
        """Put the newest of each student and notebook into ``submitted``, and give the outcome of each.

        Raises:
            OSError: One could not be written.
        """
        groups: dict[tuple[str, str, str], list[Candidate]] = defaultdict(list)
        for candidate in candidates:
            groups[candidate.assignment, candidate.student, candidate.collected.notebook].append(candidate)
        for key in sorted(groups):
            readable, unreadable = self._readable(groups[key])
            yield from unreadable
            newest, others = _newest(self._looked_into(readable))
            for other, outcome in others:
                if outcome.state == State.EARLIER:
                    self._keep(other)
                yield outcome
            if newest is not None:
                yield self._put(newest)

    def _readable(self, group: list[Candidate]) -> tuple[list[Candidate], list[Outcome]]:
        """Set aside the files that are not readable notebooks, and keep their bytes.

        A file that was cut off on its way never replaces work. If nothing else of the student is there, it is
        graded, with zero points and the reason.
        """
        reasons = [(one, why_unreadable(one.data)) for one in group]
        readable = [one for one, reason in reasons if not reason]
        if len(readable) == len(group) or not (readable or self._has_readable_work(group[0])):
            return group, []
        outcomes = []
        for one, reason in reasons:
            if reason:
                self._keep(one)
                what_to_do = f"Other work of {one.student} counts: ask for this file again if it is newer."
                outcomes.append(one.outcome(State.NOT_PLACED, f"{reason} {what_to_do}"))
        return readable, outcomes

    def _has_readable_work(self, one: Candidate) -> bool:
        """Return True if a readable notebook is at the path where this file belongs."""
        try:
            there = _lying(self._path(one))
        except UnreadableSubmission:
            return False
        return there is not None and not why_unreadable(there)

    def _path(self, one: Candidate) -> Path:
        """Return the path of the notebook in ``submitted``."""
        folder = self._directory.path / "submitted" / one.student / one.assignment
        return folder / f"{one.collected.notebook}{SUFFIX}"

    def note_times(self, times: Iterable[tuple[str, str, datetime]]) -> Iterator[tuple[str, str, datetime]]:
        """Write down the times of work that is in ``submitted`` already.

        Args:
            times: Student, assignment and time in UTC.

        Returns:
            Those that were not known yet.

        Raises:
            OSError: It could not be written.
        """
        for student, assignment, when in times:
            folder = self._directory.path / "submitted" / student / assignment
            history = self._records.get(assignment, student) or History({})
            now = dict(history.now)
            for notebook in self._directory.notebooks(assignment):
                try:
                    content = hashlib.sha256(read_bytes(folder / f"{notebook}{SUFFIX}")).hexdigest()
                except UnreadableSubmission:
                    continue
                known = now.get(notebook)
                if known is None or known.content != content:
                    known = Collected(notebook, content, "", datetime.now(tz=UTC), by_hand=True)
                now[notebook] = replace(known, when=when)
            if now != history.now:
                self._write(student, assignment, replace(history, now=now))
                yield student, assignment, when

    def _looked_into(self, group: list[Candidate]) -> list[Candidate]:
        """The files of a group, each with whether it has work; of one file alone nobody has to know."""
        if len({one.content for one in group}) == 1:
            return group
        return [replace(one, has_work=self._has_work(one, one.data)) for one in group]

    def _has_work(self, one: Candidate, data: bytes) -> bool:
        """True if a notebook of a file's student has more than what was handed out."""
        return self._handed_out.has_work(one.assignment, one.collected.notebook, data)

    def _put(self, newest: Candidate) -> Outcome:
        notebook = newest.collected.notebook
        path = self._path(newest)
        try:
            there = _lying(path)
        except UnreadableSubmission as error:
            return newest.outcome(State.NOT_PLACED, str(error))
        history = self._records.get(newest.assignment, newest.student) or History({})
        known = history.now.get(notebook)
        content = "" if there is None else hashlib.sha256(there).hexdigest()
        if known is not None and content == newest.content and not _has_news(newest.collected, known):
            return newest.outcome(State.UNCHANGED)
        if there is not None and content != newest.content:
            if content not in history.collected(notebook):
                return newest.outcome(
                    State.NOT_PLACED,
                    f"{path} is another notebook, which nobody collected: move it away first",
                )
            if known is not None and known.content != newest.content:
                refused = _older(newest, known, history) or self._mere_hand_out(newest, known, there)
                if refused is not None and refused.state == State.EARLIER:
                    self._keep(newest)
                if refused is not None:
                    return refused
            self._records.keep(newest.assignment, newest.student, content, there)
        replaced = known is not None and known.content != newest.content
        before = (*history.before, known) if known is not None and replaced else history.before
        now = {**history.now, notebook: newest.collected}
        # What is written down goes first: who is killed in between finds a notebook there that was collected.
        self._write(newest.student, newest.assignment, replace(history, now=now, before=before))
        if content != newest.content:
            write_whole(path, newest.data)
        return newest.outcome(State.PLACED, replaced=there is not None and content != newest.content)

    def _mere_hand_out(self, newest: Candidate, known: Collected, there: bytes) -> Outcome | None:
        """The outcome of a hand-out without answers that came after work; None of all else, and of what is newer."""
        if _is_said_newer(newest.collected, known) or not self._has_work(newest, there):
            return None
        if self._has_work(newest, newest.data):
            return None
        reason = "the one that is there has answers, and this one is as it was handed out: kept"
        return newest.outcome(State.EARLIER, reason)

    def _write(self, student: str, assignment: str, history: History) -> None:
        """Write down what is at its place, and when it was handed in as nbgrader reads it."""
        self._records.put(assignment, student, history)
        stamp = self._directory.path / "submitted" / student / assignment / TIMESTAMP
        if history.when is not None:
            write_whole(stamp, f"{timestamp_text(history.when)}\n".encode())
        elif stamp.parent.is_dir():
            stamp.unlink(missing_ok=True)

    def _keep(self, one: Candidate) -> None:
        """Keep what does not count; its bytes are never lost."""
        self._records.keep(one.assignment, one.student, one.content, one.data)


def _newest(group: list[Candidate]) -> tuple[Candidate | None, _Others]:
    """The file of a student's that counts, and the outcomes of the others; None where nothing says which.

    Of files that were handed in together one with work goes before one that is as it was handed out, and then the one
    counts that is called as the notebook is. What is in a folder of another name, from which the student may only have
    been guessed, is not together with it: no number that its owner gave to a file puts it before.
    """
    outcomes: _Others = []
    by_name = [one for one in group if _is_by_name(one)]
    if by_name and (people := _people(group)):
        reason = (
            f"there are several people who are read as {group[0].student}, of the numbers {people}: put the number of "
            "each into students.csv, or collect it together with that system's list"
        )
        outcomes = [(one, one.outcome(State.NOT_PLACED, reason)) for one in by_name]
        group = [one for one in group if not _is_by_name(one)]
    together: dict[tuple[Path, datetime | None, tuple[Identity, ...]], list[Candidate]] = defaultdict(list)
    for one in group:
        together[one.download, one.collected.when, one.found.readings[:1]].append(one)
    firsts: list[Candidate] = []
    for files in together.values():
        first, others = _best(
            files, lambda one: (one.has_work, one.is_named, one.collected.order, one.number)
        )
        outcomes += others
        firsts += [first] if first else []
    timed = all(one.collected.when is not None for one in firsts)
    alike = len({one.found.readings[:1] for one in firsts}) == 1
    newest, others = _best(
        firsts,
        lambda one: (
            one.collected.when.timestamp() if timed and one.collected.when else float(one.has_work),
            one.collected.order,
            one.number if alike else 0,
        ),
    )
    return newest, outcomes + others


def _is_by_name(one: Candidate) -> bool:
    """True if a name, and no number, says whose it is, though the system has a number for each person."""
    return one.collected.lms in _ONE_NUMBER and not one.is_sure


def _people(group: Iterable[Candidate]) -> str:
    """The numbers of several people who are read as one student; empty where it is one person.

    In Canvas a person has one number; elsewhere one in each download.
    """
    numbers: dict[Path | None, set[str]] = defaultdict(set)
    for one in group:
        if one.collected.lms in _ONE_NUMBER:
            numbers[None if one.collected.lms == "canvas" else one.download].add(one.collected.number)
    return next((", ".join(sorted(several)) for several in numbers.values() if len(several) > 1), "")


def _best(
    files: list[Candidate], rank: Callable[[Candidate], tuple[float, ...]]
) -> tuple[Candidate | None, _Others]:
    """The file of the highest rank, and what becomes of the others; None where several different ones have it."""
    best = max(files, key=lambda one: (rank(one), one.collected.when is not None), default=None)
    if best is None:
        return None, []
    if any(rank(one) == rank(best) and one.content != best.content for one in files):
        reason = (
            f"{best.student} has several different files for {best.assignment}, and nothing says which is the newest: "
            "collect the one that counts"
        )
        return None, [(one, one.outcome(State.NOT_PLACED, reason)) for one in files]
    others: _Others = []
    for one in files:
        if one is not best:
            same = one.content == best.content
            reason = "" if same else f"{best.label} {_why_it_counts(best, one)}"
            others.append((one, one.outcome(State.UNCHANGED if same else State.EARLIER, reason)))
    return best, others


def _why_it_counts(best: Candidate, other: Candidate) -> str:
    """The reason why a file counts and another one of the same student does not."""
    if best.has_work > other.has_work:
        return "has answers and counts; this one is as it was handed out, and is kept"
    if best.is_named <= other.is_named:
        return "is newer and counts; this one is kept"
    place = f"submitted/{best.student}/{best.assignment}/{best.collected.notebook}{SUFFIX}"
    return f"has the notebook's own name and counts; this one is kept: to let it count, put it at {place}"


def _has_news(newest: Collected, known: Collected) -> bool:
    """True if the same notebook comes with a later time, or has its first one now."""
    return newest.when is not None and (known.when is None or newest.when > known.when)


def _is_said_newer(new: Collected, known: Collected) -> bool:
    """True if a time or a number says that a file goes before the one that is there."""
    if new.lms == known.lms == "canvas" and new.number != known.number:
        return True  # what is there is of somebody else
    if new.when is not None and known.when is not None and new.when != known.when:
        return new.when > known.when
    return _is_later_in_order(new, known)


def _is_later_in_order(one: Collected, other: Collected) -> bool:
    """True if both files have an order, and the first one comes later in it."""
    return bool(one.order and other.order) and one.order > other.order


def _older(newest: Candidate, known: Collected, history: History) -> Outcome | None:
    """The outcome of a file that does not replace the one that is there; None where it does."""
    new = newest.collected
    came, lay = repository_of(new), repository_of(known)
    # One that is called as the student is, no more, is the student's.
    if came and lay and came != lay and new.number not in (came, lay):
        return newest.outcome(
            State.NOT_PLACED,
            f"the one that is there came from another repository, {known.source}, and only the end of this one's name "
            f"is {newest.student}'s: if it counts, put it into submitted/ yourself",
        )
    if new.lms == known.lms == "canvas" and new.number != known.number:
        if newest.is_sure:
            return None  # what is there is of somebody who took the student's name
        return newest.outcome(
            State.NOT_PLACED,
            f"the one that is there is of number {known.number} in Canvas, and this one of {new.number}: put the "
            f"number of {newest.student} into the column canvas of students.csv",
        )
    if new.when is not None and known.when is not None and new.when != known.when:
        if new.when < known.when:
            at = f"{known.when:%Y-%m-%d %H:%M} UTC"
            return newest.outcome(State.EARLIER, f"the one that is there was handed in later ({at})")
        return None
    if _is_later_in_order(known, new):
        return newest.outcome(State.EARLIER, "the one that is there was handed in later")
    # A number says that it is newer, not when: late work would count as if it had been handed in on time.
    is_newer = _is_later_in_order(new, known)
    if is_newer and (new.when is not None or known.when is None):
        return None
    if not is_newer and any(one.content == newest.content for one in history.before):
        return newest.outcome(State.EARLIER, "it was collected before, and a newer one after it")
    if known.when is not None:
        unknown = "when it was handed in, which is known of" if is_newer else "whether it is newer than"
        return newest.outcome(
            State.NOT_PLACED,
            f"nothing says {unknown} the one that is there, handed in {known.when:%Y-%m-%d %H:%M} UTC: say when, with "
            "--handed-in TIME or --times FILE",
        )
    return None


def _lying(path: Path) -> bytes | None:
    """The file at a notebook's place; None where there is none.

    Raises:
        UnreadableSubmission: Something else does.
    """
    for place in (path.parent.parent, path.parent, path):
        if place.is_symlink():
            raise UnreadableSubmission(f"{place} is a link: remove it")
    try:
        return read_bytes(path) if path.exists() else None
    except UnreadableSubmission as error:
        raise UnreadableSubmission(f"something else lies at {path}: {error}") from error
