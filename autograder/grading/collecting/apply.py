"""Makes ``submitted`` contain exactly the files that count according to the decisions.

It never replaces or removes files other than those that ``collect`` itself wrote.
"""

from __future__ import annotations

import hashlib
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory
from autograder.grading.classes.timestamps import TIMESTAMP, timestamp_text
from autograder.grading.collecting.inbox import BY_HAND, Arrival, Delivery, Inbox
from autograder.grading.collecting.outcomes import State
from autograder.grading.collecting.records import Collected, CollectedRecords, History
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from autograder.grading.collecting.deciding.decide import Decision, Place
    from autograder.grading.collecting.deciding.proposals import Line


class Submitted:
    """The folder ``submitted`` of a class.

    Args:
        directory: The class, which this process has locked.
        inbox: The inbox of the class.
    """

    def __init__(self, directory: ClassDirectory, inbox: Inbox) -> None:
        self._directory = directory
        self._inbox = inbox
        self._records = CollectedRecords(directory.state)

    def path(self, place: Place) -> Path:
        """Return the path of a notebook."""
        student, assignment, notebook = place
        return self._directory.path / "submitted" / student / assignment / f"{notebook}{SUFFIX}"

    def content(self, place: Place) -> str:
        """Return the hash of the file at a place; empty if there is no readable file."""
        try:
            data = _existing_file(self.path(place))
        except UnreadableSubmission:
            return ""
        return hashlib.sha256(data).hexdigest() if data is not None else ""

    def take_in(self) -> None:
        """Copy into the inbox the files that a person has put directly into ``submitted``.

        Raises:
            OSError: A file could not be written.
        """
        known = {
            file for one in self._inbox.deliveries.values() if one.form == BY_HAND for file in one.arrivals
        }
        for submission in self._directory.submissions()[0]:
            student, assignment = submission.student, submission.assignment
            history = self._records.get(assignment, student) or History({})
            for notebook in self._directory.notebooks(assignment):
                place = (student, assignment, notebook)
                content = self.content(place)
                arrival = Arrival("submitted", (student, assignment, f"{notebook}{SUFFIX}"), content=content)
                is_ours = content in history.written(notebook) and content in self._inbox
                if content and not is_ours and arrival not in known:
                    with self._inbox.receiving() as receiving:
                        receiving.keep(read_bytes(self.path(place)))
                        receiving.delivery = Delivery((arrival,), form=BY_HAND)

    def bring(
        self, counts: Mapping[Place, Line], decisions: Iterable[Decision]
    ) -> Iterator[tuple[Place, State, str]]:
        """Put each notebook that counts at its place, and remove notebooks that no longer count.

        Returns:
            For each changed or checked place, a state and the reason. The state is ``PLACED``, ``UNCHANGED``,
            ``EARLIER`` (removed) or ``NOT_PLACED``.

        Raises:
            OSError: A file could not be written.
        """
        refused: dict[Place, set[str]] = defaultdict(set)
        for one in decisions:
            if one.state == State.LEFT_OUT:
                refused[one.place].add(one.line.content)
        wanted: dict[tuple[str, str], dict[str, Line]] = defaultdict(dict)
        for (student, assignment, notebook), line in counts.items():
            wanted[student, assignment][notebook] = line
        for key in sorted({*wanted, *self._records.all(), *(place[:2] for place in refused if all(place))}):
            yield from self._bring(*key, wanted[key], refused)

    def _bring(
        self,
        student: str,
        assignment: str,
        wanted: Mapping[str, Line],
        refused: Mapping[Place, set[str]],
    ) -> Iterator[tuple[Place, State, str]]:
        old = self._records.get(assignment, student) or History({})
        now: dict[str, Collected] = {}
        changes: list[tuple[Place, Line | None, str]] = []
        names = {place[2] for place in refused if place[:2] == (student, assignment)}
        for notebook in sorted({*wanted, *old.now, *names}):
            place, line = (student, assignment, notebook), wanted.get(notebook)
            try:
                there = _existing_file(self.path(place))
            except UnreadableSubmission as error:
                now |= {notebook: old.now[notebook]} if notebook in old.now else {}
                if line:
                    yield place, State.NOT_PLACED, str(error)
                continue
            content = hashlib.sha256(there).hexdigest() if there is not None else ""
            if line is None:
                ours = old.written(notebook) | refused.get(place, set())
                if content and content in self._inbox and content in ours:
                    changes.append((place, None, content))
                continue
            known = old.now.get(notebook)
            if not line.is_by_hand or line.when or line.use or known:
                now[notebook] = _record(line)
            if content == line.content:
                yield place, State.UNCHANGED, ""
            else:
                changes.append((place, line, content))
        history = History(now)
        # Write the record before the files. If this is interrupted, the next `collect` still recognizes the files as
        # its own.
        passing = {place[2]: content for place, _, content in changes if content}
        if changes:
            self._records.put(assignment, student, replace(history, replaced=passing))
        for place, line, content in changes:
            if line is None:
                self.path(place).unlink()
                yield place, State.EARLIER, ""
            else:
                write_whole(self.path(place), self._inbox.read(line.content))
                yield place, State.PLACED, "replaced" if content else ""
        if history != old and (now or old != History({})):
            self._records.put(assignment, student, history)
        if now or changes:
            self._stamp(student, assignment, history)

    def _stamp(self, student: str, assignment: str, history: History) -> None:
        """Write the time of handing in, in nbgrader's format."""
        stamp = self._directory.path / "submitted" / student / assignment / TIMESTAMP
        text = f"{timestamp_text(history.when)}\n".encode() if history.when else b""
        if text:
            try:
                if read_bytes(stamp) == text:
                    return
            except UnreadableSubmission:
                pass
            write_whole(stamp, text)
        elif stamp.parent.is_dir():
            stamp.unlink(missing_ok=True)
            if not any(stamp.parent.iterdir()):
                stamp.parent.rmdir()
                if not any(stamp.parent.parent.iterdir()):
                    stamp.parent.parent.rmdir()


def _record(line: Line) -> Collected:
    """Return the record of a notebook that was placed."""
    return Collected(
        line.notebook,
        line.content,
        when=line.when,
        lms="" if line.is_by_hand else line.lms,
        number=line.number,
        name=line.name,
        file=line.file,
        by_hand=line.is_by_hand,
    )


def _existing_file(path: Path) -> bytes | None:
    """Return the content of the file at a notebook's place; None if there is no file.

    Raises:
        UnreadableSubmission: Something other than an ordinary file is at that place.
    """
    for place in (path.parent.parent, path.parent, path):
        if place.is_symlink():
            raise UnreadableSubmission(f"{place} is a link: remove it")
    try:
        return read_bytes(path) if path.exists() else None
    except UnreadableSubmission as error:
        raise UnreadableSubmission(f"something else is at {path}: {error}") from error
