"""Decides which file of a student is graded, independently of the order in which the files came."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.grading.classes.class_directory import SUFFIX, in_zone
from autograder.grading.collecting.collected_files import Line, LineState, Place
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding.notebook_parsing import parse
from autograder.grading.rebuilding.notebook_rebuilding import grade_id, is_answer
from autograder.grading.rebuilding.submission_desk import read_notebook
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.submitted_folder import Submitted


def decide(lines: Iterable[Line], submitted: Submitted) -> list[Line]:
    """Return the lines with a state and a reason. The work of a group becomes one line for each student.

    Args:
        lines: The lines of all files.
        submitted: The folder with the files that are graded so far.
    """
    decided: list[Line] = []
    soft: list[Line] = []
    by_place: dict[Place, list[Line]] = defaultdict(list)
    for line in sorted(lines, key=lambda one: (one.key, one.assignment)):
        if line.use == "no":
            decided.append(replace(line, state=LineState.LEFT_OUT, reason="no is written under use"))
        elif line.is_soft:
            soft.append(line)
        elif line.reason:
            decided.append(replace(line, reason=_with_cell(line.reason)))
        else:
            for student in line.students:
                own = replace(line, students=(student,))
                by_place[own.place].append(own)
    for place, files in by_place.items():
        decided += _of_notebook(place, files, submitted)
    handed_in = {
        (one.student, one.assignment) for one in decided if one.state in (LineState.PLACED, LineState.EARLIER)
    }
    handed_in |= {(student, "") for student, _ in handed_in}
    for line in soft:
        # A file that is not a notebook waits for a person only if its student has handed in no notebook.
        is_beside = line.lms == "list" or (line.student and (line.student, line.assignment) in handed_in)
        decided.append(
            replace(line, state=LineState.BESIDE)
            if is_beside
            else replace(line, reason=_with_cell(line.reason))
        )
    return decided


def _with_cell(reason: str) -> str:
    """Return the reason. If it does not name a cell to edit, add how to leave the file out."""
    return reason if cell_in(reason) else f"{reason.rstrip('.')}; to leave the file out, write no under use"


_CELL = re2.compile(r"(?:under|the cell) (use|student|assignment|notebook|handed_in)\b")


def cell_in(reason: str) -> str:
    """Return the first column of the table that a reason names; empty if it names none."""
    found = _CELL.search(reason)
    return found[1] if found else ""


def _of_notebook(place: Place, files: list[Line], submitted: Submitted) -> Iterator[Line]:
    """Yield, for each file that a student handed in for one notebook, its state and the reason for that state."""
    by_hand = [one for one in files if one.is_by_hand]
    present = [one for one in by_hand if submitted.content(place) == one.content]
    chosen = present or [one for one in files if one.use == "yes"]
    pool = chosen or [one for one in files if not one.is_by_hand]
    for sift in () if chosen else (_ambiguous_names, _unreadable):
        doubts = sift(place, pool)
        yield from doubts
        doubtful = {one.key for one in doubts}
        pool = [one for one in pool if one.key not in doubtful]
    best, others = _best(place, pool, submitted) if pool else (None, [])
    yield from others
    if best:
        # If a person corrected the file in ``submitted``, the student's own time of handing in still applies.
        times = [one.when for one in files if one.when and present]
        best = replace(best, when=best.when or max(times, default=None))
        if known := [one for one in files if one.number and present]:
            there = max(known, key=lambda one: (one.when.timestamp() if one.when else 0, one.order))
            best = replace(best, via=there.lms, number=there.number, name=there.name, file=there.file)
        yield _timed(best, files, submitted)
    why = "the file was in submitted before: write yes under use to put it there again"
    if chosen:
        put_there = "was put into the folder submitted by hand, and is graded"
        why = f"{chosen[0].label} {put_there if present else 'is graded, because yes is written under use'}"
    for one in (one for one in files if one not in chosen and (chosen or one.is_by_hand)):
        is_same = chosen and best and one.content == best.content
        state, reason = (LineState.UNCHANGED, "") if is_same else (LineState.EARLIER, why)
        yield replace(one, state=state, reason=reason)


def _timed(best: Line, files: Sequence[Line], submitted: Submitted) -> Line:
    """Return the file to grade with the first time at which the same bytes came, unless a person wrote another one."""
    first = min((one.first for one in files if one.first and one.content == best.content), default=None)
    if not best.when or not first or first >= best.when or best.time_from == "handed_in":
        return replace(best, state=LineState.PLACED)
    again = in_zone(best.when, submitted.directory.time_zone)
    reason = f"the same bytes were handed in again on {again}: the first time counts"
    return replace(best, when=first, state=LineState.PLACED, reason=reason)


_ONE_NUMBER = ("canvas", "moodle", "brightspace")
"""The LMSs in which users may change their names, but have the same number in all files of a download."""


def _ambiguous_names(place: Place, pool: Sequence[Line]) -> list[Line]:
    """Return the files that are linked to a student only by a name, if several people have this name.

    Several people have the name if the LMS gives it several numbers. In Canvas, a person has the same number in every
    download, so the numbers of all downloads are compared. In other systems, only the numbers in one download are
    compared.
    """
    numbers: dict[str, set[str]] = defaultdict(set)
    of_systems = [one for one in pool if one.lms in _ONE_NUMBER]
    for one in of_systems:
        for download in ("canvas",) if one.lms == "canvas" else one.came_in:
            numbers[download].add(one.number)
    several = next((sorted(found) for found in numbers.values() if len(found) > 1), [])
    reason = (
        f"several people in the LMS have the name of {place[0]}; their numbers are {', '.join(several)}: write the id "
        "under student, or no under use"
    )
    return [_waiting(one, reason) for one in of_systems if several and not one.is_sure]


def _unreadable(place: Place, pool: Sequence[Line]) -> list[Line]:
    """Return the unreadable files, which neither replace readable work nor become zero points without a word."""
    what_to_do = (
        "Ask the student for the file again; to have it graded as it is, without points, write yes under use"
        if all(one.unreadable for one in pool)
        else f"Another file of {place[0]} is graded: ask for this file again if it is newer, or write no under use"
    )
    return [_waiting(one, f"{one.unreadable} {what_to_do}") for one in pool if one.unreadable]


def _waiting(line: Line, reason: str) -> Line:
    return replace(line, state=LineState.NOT_PLACED, reason=reason)


def _best(place: Place, files: Sequence[Line], submitted: Submitted) -> tuple[Line | None, list[Line]]:
    """Return the file to grade, or None if a person has to choose; and the decisions about the other files.

    The file with the newest time of handing in is graded. If the times are equal or unknown, a file with answers is
    preferred to a file without answers. Next, in one download, a file with the notebook's exact name is preferred; and
    last, the file with the highest number from the system. If several different files are left, the file that is
    already in ``submitted`` is graded again.
    """
    there = submitted.content(place)
    contents = {one.content for one in files}
    work = {
        one.content: len(contents) == 1
        or _has_work(submitted.directory, one.assignment, one.notebook, submitted.inbox.read(one.content))
        for one in files
    }
    timed = [one for one in files if one.when]
    best = _top(timed or files, lambda one: one.when.timestamp() if one.when else 0)
    best = _top(best, lambda one: work[one.content])
    named = [one for one in best if one.is_named]
    if named and all(any(one.came_in & other.came_in for one in named) for other in best):
        best = named
    if len({one.lms for one in best}) == 1:  # attempt numbers of different LMSs cannot be compared
        best = _top(best, lambda one: one.order)
    is_one = len({one.content for one in best}) == 1
    best = _top(best, lambda one: bool(one.lms)) if is_one else best
    first = next((one for one in best if one.content == there), best[0])
    if not is_one and first.content != there:
        reason = (
            f"{place[0]} has several different files for {place[1]}, and it is unknown which file is the newest: "
            "write yes under use for the file to grade, or the times under handed_in"
        )
        return None, [_waiting(one, reason) for one in files]
    others: list[Line] = []
    with_work = [one for one in files if work[one.content]]
    if with_work and not work[first.content]:
        last = _top(with_work, lambda one: one.when.timestamp() if one.when else 0)[0]
        words = f"nothing is written in it, and {last.label} has answers: to have it graded, write yes under use there"
        first = replace(first, reason=words)
    at = f", handed in {in_zone(first.when, submitted.directory.time_zone)}" if first.when else ""
    for one in (one for one in files if one.key != first.key):
        is_older = work[one.content] < work[first.content] or (
            one.lms == first.lms and 0 < one.order < first.order
        )
        unknown = f"it is unknown whether this file is newer than {first.label}"
        if one.content == first.content:
            others.append(replace(one, state=LineState.UNCHANGED, reason=""))
        elif one in best:
            reason = f"{unknown}, which is graded: write yes under use to have this file graded, or no"
            others.append(_waiting(one, reason))
        elif first.when and not one.when and not is_older:
            reason = f"{unknown}{at}: write the file's time under handed_in"
            others.append(_waiting(one, reason))
        else:
            reason = f"{first.label} {_why_it_counts(first, one, work)}"
            others.append(replace(one, state=LineState.EARLIER, reason=reason))
    return first, others


def _has_work(directory: ClassDirectory, assignment: str, notebook: str, data: bytes) -> bool:
    """Return True if a notebook has an answer, or an added cell, that was not handed out.

    The student's notebook is compared with those in ``release`` and in ``source``, because ``release`` may be older. If
    one of these two cannot be read, every notebook counts as containing work. But if the student's notebook cannot be
    read, it counts as containing none.

    Args:
        directory: The class.
        assignment: The name of the assignment.
        notebook: The name of the notebook.
        data: The bytes that a student handed in.
    """
    try:
        cells, _ = read_notebook(data, directory.state)
    except UnreadableSubmission:
        return False
    try:
        source = directory.master(assignment, notebook).cells
        released, _ = parse(read_bytes(directory.path / "release" / assignment / f"{notebook}{SUFFIX}"))
    except (GradingError, UnreadableSubmission):
        return True
    given = {"", *(cell.source.strip() for cell in (*source, *released))}
    unchanged = {grade_id(cell) for cell in source if not is_answer(cell)} - {""}
    return any(cell.source.strip() not in given for cell in cells if cell.grade_id not in unchanged)


def _top(files: Sequence[Line], rank: Callable[[Line], float]) -> list[Line]:
    """Return the files with the highest rank."""
    highest = max(map(rank, files))
    return [one for one in files if rank(one) == highest]


def _why_it_counts(best: Line, other: Line, work: dict[str, bool]) -> str:
    if work[best.content] > work[other.content]:
        return "has answers and is graded; this file has no answers, and is kept as an earlier attempt"
    if best.is_named > other.is_named:
        return (
            "has the notebook's exact name and is graded; this file is kept as an earlier attempt: to have it graded "
            "instead, write yes under use"
        )
    return "is newer and is graded; this file is kept as an earlier attempt"
