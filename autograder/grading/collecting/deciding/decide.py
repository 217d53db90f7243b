"""Decides which file of a student counts. The result does not depend on the order in which the files came."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import re2

from autograder.grading.classes.class_directory import in_zone
from autograder.grading.collecting.deciding.handed_out import HandedOut
from autograder.grading.collecting.outcomes import State
from autograder.grading.rebuilding.desk import why_unreadable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from datetime import datetime

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.apply import Submitted
    from autograder.grading.collecting.deciding.proposals import Line
    from autograder.grading.collecting.inbox import Inbox

Place = tuple[str, str, str]
"""The place of a notebook: student, assignment and notebook."""
_Why = tuple["Line", State, str]
_ONE_NUMBER = ("canvas", "moodle", "brightspace")
"""The systems that give each person one number in a download, and in which users may change their names."""
_CELL = re2.compile(r"(?:under|the cell) (use|student|assignment|notebook|handed_in)\b")


class Looks:
    """Questions about a class and the content of its files. They are asked only if more than one file may count.

    Args:
        directory: The class.
        inbox: The inbox of the class.
        submitted: The folder ``submitted`` of the class.
    """

    def __init__(self, directory: ClassDirectory, inbox: Inbox, submitted: Submitted) -> None:
        self._zone = directory.time_zone
        self._handed_out = HandedOut(directory)
        self._inbox = inbox
        self._submitted = submitted

    def has_work(self, line: Line) -> bool:
        """Return True if the notebook contains more than what was handed out."""
        return self._handed_out.has_work(line.assignment, line.notebook, self._inbox.read(line.content))

    def why_unreadable(self, line: Line) -> str:
        """Return why the notebook cannot be read; empty if it can."""
        return why_unreadable(self._inbox.read(line.content))

    def is_there(self, line: Line, place: Place) -> bool:
        """Return True if the file with these bytes is at its place in ``submitted``."""
        return self._submitted.content(place) == line.content

    def shown(self, when: datetime) -> str:
        """Return a time as text, in the time zone of the class."""
        return in_zone(when, self._zone)


@dataclass(frozen=True)
class Decision:
    """The decision about a file for one student.

    Attributes:
        line: The file, with everything that is known about it.
        student: The id of the student; empty if it is unknown, or if the file belongs to a group.
        state: The state of the file: ``PLACED`` if it counts.
        reason: The reason, for every state except ``PLACED``.
    """

    line: Line
    student: str
    state: State
    reason: str = ""

    @property
    def place(self) -> Place:
        """The place of the notebook."""
        return self.student, self.line.assignment, self.line.notebook


def decide(lines: Iterable[Line], looks: Looks) -> tuple[list[Decision], dict[Place, Line]]:
    """Decide about all files.

    Returns:
        A decision for each file and student; and the file that counts, for each notebook.
    """
    decisions: list[Decision] = []
    soft: list[Line] = []
    groups: dict[Place, list[Line]] = defaultdict(list)
    for line in sorted(lines, key=lambda one: (one.key, one.assignment)):
        student = line.students[0] if len(line.students) == 1 else ""
        if line.use == "no":
            decisions.append(Decision(line, student, State.LEFT_OUT, "no is written under use"))
        elif line.is_soft:
            soft.append(line)
        elif line.reason:
            decisions.append(Decision(line, student, State.NOT_PLACED, _with_cell(line.reason)))
        else:
            for one in line.students:
                groups[one, line.assignment, line.notebook].append(line)
    counts = {}
    for place, group in groups.items():
        for line, state, reason in _of_group(place, group, looks):
            decisions.append(Decision(line, place[0], state, reason))
            if state == State.PLACED:
                counts[place] = line
    known = {(student, line.content) for (student, _, _), line in counts.items()}
    decisions = [
        replace(one, state=State.UNCHANGED, reason="")
        if one.state == State.NOT_PLACED and (one.student, one.line.content) in known
        else one
        for one in decisions
    ]
    came = {
        (one.student, one.line.assignment) for one in decisions if one.state in (State.PLACED, State.EARLIER)
    }
    came |= {(student, "") for student, _ in came}
    return decisions + [_beside(line, came) for line in soft], counts


def _beside(line: Line, came: set[tuple[str, str]]) -> Decision:
    """Return the decision about a file that needs no attention once a notebook of its student was collected."""
    student = line.students[0] if len(line.students) == 1 else ""
    if line.lms == "list" or (student and (student, line.assignment) in came):
        return Decision(line, student, State.BESIDE, line.reason)
    reason = f"{line.reason}: {line.what_to_do}" if line.what_to_do else line.reason
    return Decision(line, student, State.NOT_PLACED, _with_cell(reason))


def _with_cell(reason: str) -> str:
    """Return a reason that names the cell to edit."""
    return reason if cell_in(reason) else f"{reason.rstrip('.')}; to leave it out, write no under use"


def cell_in(reason: str) -> str:
    """Return the first column of the table that a reason names; empty if it names none."""
    found = _CELL.search(reason)
    return found[1] if found else ""


def _of_group(place: Place, group: list[Line], looks: Looks) -> Iterator[_Why]:
    """Decide between the files of one student for one notebook."""
    by_hand = [one for one in group if one.is_by_hand]
    lying = [one for one in by_hand if looks.is_there(one, place)]
    chosen = lying or [one for one in group if one.use == "yes"]
    if chosen:
        best, others = _best(chosen, _time, place, looks)
        yield from others
        if best:
            # A later correction of a file does not change the time at which its student handed it in.
            times = [one.when for one in group if one.when and lying]
            yield replace(best, when=best.when or max(times, default=None)), State.PLACED, ""
        why = "was put there by hand and counts" if lying else "counts, since yes is written under use"
        for one in group:
            if one not in chosen:
                same = best and one.content == best.content
                yield one, *((State.UNCHANGED, "") if same else (State.EARLIER, f"{chosen[0].label} {why}"))
        return
    for one in by_hand:
        yield one, State.EARLIER, "it was in submitted before: write yes under use to put it there again"
    pool = [one for one in group if not one.is_by_hand]
    for sift in (_people, _unreadable):
        doubts = sift(place, pool, looks)
        yield from ((one, State.NOT_PLACED, reason) for one, reason in doubts)
        doubtful = {one.key for one, _ in doubts}
        pool = [one for one in pool if one.key not in doubtful]
    best, whys = _newest(place, pool, looks)
    yield from whys
    if best:
        yield best, State.PLACED, ""


def _people(place: Place, pool: Sequence[Line], _: Looks) -> list[tuple[Line, str]]:
    """Return the files that belong to a student only by a name that several people or repositories have.

    In Canvas each person has one number; in other systems, one number per download.
    """
    numbers: dict[str, set[str]] = defaultdict(set)
    for one in pool:
        if one.lms in _ONE_NUMBER:
            for download in ("canvas",) if one.lms == "canvas" else one.came_in:
                numbers[download].add(one.number)
        elif one.repository:
            numbers["github"].add(one.repository)
    several = {lms: sorted(found) for lms, found in numbers.items() if len(found) > 1}
    repositories = several.pop("github", [])
    whose = (
        f"work came from several repositories, {' and '.join(repositories)}, and only the ends of their names are "
        f"{place[0]}'s"
    )
    found = [(one, whose) for one in pool if repositories and one.repository not in ("", one.number)]
    people = f"there are several people who are read as {place[0]}, of the numbers "
    by_name = [one for one in pool if several and one.lms in _ONE_NUMBER and not one.is_sure]
    found += [(one, people + ", ".join(next(iter(several.values())))) for one in by_name]
    return [(one, f"{why}: write the id under student, or no under use") for one, why in found]


def _unreadable(place: Place, pool: Sequence[Line], looks: Looks) -> list[tuple[Line, str]]:
    """Return the unreadable files; none if all are unreadable. An incomplete file must not replace readable work."""
    if len({one.content for one in pool}) < 2:
        return []
    reasons = [(one, reason) for one in pool if (reason := looks.why_unreadable(one))]
    what_to_do = (
        f"Other work of {place[0]} counts: ask for this file again if it is newer, or write no under use"
    )
    return [(one, f"{reason} {what_to_do}") for one, reason in reasons] if len(reasons) < len(pool) else []


def _newest(place: Place, pool: list[Line], looks: Looks) -> tuple[Line | None, list[_Why]]:
    """Return the file that counts, and why the others do not; None if it is unclear which is the newest.

    Of files that were handed in together, a file with work takes precedence over one that is unchanged since it was
    handed out; after that, the exact name decides. Between attempts, the time decides, or else the system's
    numbering.
    """
    is_several = len({one.content for one in pool}) > 1
    work = {one.key: not is_several or looks.has_work(one) for one in pool}
    firsts: list[Line] = []
    whys: list[_Why] = []
    for files in _together(pool):

        def rank(one: Line) -> tuple[float, ...]:
            return work[one.key], one.is_named, one.order, one.number_of_copy

        first, others = _best(files, rank, place, looks, work)
        whys += others
        firsts += [first] if first else []
    alike = len({one.readings[:1] for one in firsts}) == 1
    is_ordered = len({one.lms for one in firsts}) == 1  # the numbers of two systems have nothing in common
    timed = [one for one in firsts if one.when is not None]

    def later(one: Line) -> tuple[float, ...]:
        order = one.order if is_ordered else 0
        return *(_time(one) if timed else (work[one.key],)), order, one.number_of_copy if alike else 0

    best, others = _best(timed or firsts, later, place, looks, work)
    whys += others
    for one in firsts if timed else ():
        if one.when is None:
            whys.append((one, *_without_time(one, best, work, looks)))
    return best, whys


def _together(pool: Iterable[Line]) -> list[list[Line]]:
    """Return the groups of files that were handed in together: by one person, at one time, in one download."""
    found: list[list[Line]] = []
    for one in pool:
        mine = [one]
        for files in [files for files in found if _is_together(one, files)]:
            mine += files
            found.remove(files)
        found.append(sorted(mine, key=lambda line: line.key))
    return found


def _is_together(one: Line, files: Sequence[Line]) -> bool:
    return any(
        (one.when, one.readings[:1]) == (other.when, other.readings[:1]) and one.came_in & other.came_in
        for other in files
    )


def _time(one: Line) -> tuple[float, ...]:
    return (one.when.timestamp() if one.when else 0.0,)


def _without_time(one: Line, best: Line | None, work: dict[str, bool], looks: Looks) -> tuple[State, str]:
    """Return the decision about a file whose time is unknown, given the best file whose time is known."""
    if best is None or best.when is None:
        return State.NOT_PLACED, "nothing says when it was handed in: write the time under handed_in"
    if one.content == best.content:
        return State.UNCHANGED, ""
    at = f"{best.label}, handed in {looks.shown(best.when)}"
    if one.order and best.order and one.lms == best.lms and one.order < best.order:
        return State.EARLIER, f"{at}, was handed in later"
    if work[best.key] and not work[one.key]:
        return State.EARLIER, f"{at}, has answers; this one is as it was handed out, and is kept"
    return State.NOT_PLACED, f"nothing says whether it is newer than {at}: write its time under handed_in"


def _best(
    files: list[Line],
    rank: Callable[[Line], tuple[float, ...]],
    place: Place,
    looks: Looks,
    work: dict[str, bool] | None = None,
) -> tuple[Line | None, list[_Why]]:
    """Return the file with the highest rank, and the decisions about the others.

    If several different files have that rank, the one that counted before still counts; None if none did.
    """
    best = max(files, key=lambda one: (rank(one), one.when is not None, bool(one.lms)), default=None)
    if best is None:
        return None, []
    rivals = [one for one in files if rank(one) == rank(best) and one.content != best.content]
    if applied := next((one for one in (best, *rivals) if rivals and looks.is_there(one, place)), None):
        best = applied
    elif rivals:
        reason = (
            f"{place[0]} has several different files for {place[1]}, and nothing says which is the newest: "
            "write yes under use for the one that counts, or the times under handed_in"
        )
        return None, [(one, State.NOT_PLACED, reason) for one in files]
    others: list[_Why] = []
    for one in files:
        if one.content == best.content and one is not best:
            others.append((one, State.UNCHANGED, ""))
        elif applied and rank(one) == rank(best):
            reason = (
                f"nothing says whether it is newer than {best.label}, which counts: write yes under use if this one "
                "is to count, or no"
            )
            others.append((one, State.NOT_PLACED, reason))
        elif one is not best:
            others.append((one, State.EARLIER, f"{best.label} {_why_it_counts(best, one, work or {})}"))
    return best, others


def _why_it_counts(best: Line, other: Line, work: dict[str, bool]) -> str:
    if work.get(best.key, True) > work.get(other.key, True):
        return "has answers and counts; this one is as it was handed out, and is kept"
    if best.is_named > other.is_named:
        return (
            "has the notebook's own name and counts; this one is kept: to let it count, write yes under use"
        )
    return "is newer and counts; this one is kept"
