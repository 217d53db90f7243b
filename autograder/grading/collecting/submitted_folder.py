"""The folder ``submitted`` of a class: brings the notebooks to grade into it, and finds files that are misplaced in it.

A file in ``submitted`` that ``collect`` did not write is never replaced or removed. A misplaced file is not graded,
because its folder or its name is wrong.
"""

from __future__ import annotations

import contextlib
import hashlib
import unicodedata
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.command_name import COMMAND
from autograder.grading.classes.class_directory import SUFFIX, TIMESTAMP, ClassDirectory, timestamp_text
from autograder.grading.classes.student_folders import RefusedFile
from autograder.grading.collecting.collected_files import (
    BY_HAND,
    Arrival,
    CollectedRecords,
    Delivery,
    History,
    Inbox,
    LineState,
)
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping
    from pathlib import Path

    from autograder.grading.collecting.collected_files import Line, Place


class Submitted:
    """The folder ``submitted`` of a class.

    Args:
        directory: The class, which this process has locked.
        inbox: The inbox of the class.

    Attributes:
        directory: The class, with the notebooks that were handed out.
        inbox: The inbox, with the bytes of the files.
    """

    def __init__(self, directory: ClassDirectory, inbox: Inbox) -> None:
        self.directory = directory
        self.inbox = inbox
        self._records = CollectedRecords(directory.state)

    def _path(self, place: Place) -> Path:
        """Return the path of a notebook in ``submitted``."""
        student, assignment, notebook = place
        return self.directory.path / "submitted" / student / assignment / f"{notebook}{SUFFIX}"

    def content(self, place: Place) -> str:
        """Return the hash of a notebook in ``submitted``; empty if it does not exist or cannot be read."""
        try:
            return _existing_content(self._path(place))
        except UnreadableSubmission:
            return ""

    def take_in(self) -> None:
        """Copy into the inbox the files that a person has put directly into ``submitted``.

        Raises:
            OSError: A file could not be written.
        """
        for submission in self.directory.submissions()[0]:
            student, assignment = submission.student, submission.assignment
            history = self._records.get(assignment, student) or History({})
            for notebook in self.directory.notebooks(assignment):
                place = (student, assignment, notebook)
                content = self.content(place)
                arrival = Arrival("submitted", (student, assignment, f"{notebook}{SUFFIX}"), content=content)
                delivery = Delivery((arrival,), form=BY_HAND)
                is_ours = content in history.written(notebook) and content in self.inbox
                if content and not is_ours and delivery.id not in self.inbox.deliveries:
                    with self.inbox.receiving() as receiving:
                        receiving.keep(read_bytes(self._path(place)))
                        receiving.delivery = delivery

    def bring(self, lines: Iterable[Line]) -> dict[Place, tuple[LineState, str]]:
        """Write each notebook to grade into ``submitted``, and remove notebooks that are no longer to be graded.

        Returns:
            The change of each notebook, with its reason: ``PLACED`` (written), ``UNCHANGED`` (already there),
            ``EARLIER`` (removed) or ``NOT_PLACED`` (could not be written).

        Raises:
            OSError: A file could not be written.
        """
        wanted: dict[tuple[str, str], dict[str, Line]] = defaultdict(dict)
        refused = set()
        for one in lines:
            if one.state == LineState.PLACED:
                wanted[one.place[:2]][one.notebook] = one
            elif one.state == LineState.LEFT_OUT and all(one.place):
                refused.add((one.place, one.content))
        keys = {*wanted, *self._records.all(), *(place[:2] for place, _ in refused)}
        results = (self._bring_submission(*key, wanted[key], refused) for key in sorted(keys))
        return {place: (state, why) for several in results for place, state, why in several}

    def _bring_submission(
        self,
        student: str,
        assignment: str,
        wanted: Mapping[str, Line],
        refused: Collection[tuple[Place, str]],
    ) -> Iterator[tuple[Place, LineState, str]]:
        old = self._records.get(assignment, student) or History({})
        now: dict[str, Line] = {}
        changes: list[tuple[Place, Line | None, str]] = []
        names = {place[2] for place, _ in refused if place[:2] == (student, assignment)}
        for notebook in sorted({*wanted, *old.now, *names}):
            place, line = (student, assignment, notebook), wanted.get(notebook)
            known = old.now.get(notebook)
            try:
                content = _existing_content(self._path(place))
            except UnreadableSubmission as error:
                now |= {notebook: known} if known else {}
                if line:
                    yield place, LineState.NOT_PLACED, str(error)
                continue
            # A file that a person put here gets a record only when `collect` knows more of it than its place.
            if line and (known or not line.is_by_hand or line.when or line.use):
                now[notebook] = line
            is_ours = content in old.written(notebook) or (place, content) in refused
            if line and content == line.content:
                yield place, LineState.UNCHANGED, ""
            elif line or (content and content in self.inbox and is_ours):
                changes.append((place, line, content))
        history = History(now)
        # Write the record before the files, so that the next `collect` knows that these files are its own even if this
        # command is interrupted.
        replaced = {place[2]: content for place, _, content in changes if content}
        if changes:
            self._records.put(assignment, student, replace(history, replaced=replaced))
        for place, line, content in changes:
            if line is None:
                self._path(place).unlink()
                yield place, LineState.EARLIER, ""
            else:
                write_whole(self._path(place), self.inbox.read(line.content))
                yield place, LineState.PLACED, "instead of an earlier file" if content else ""
        if history != old and (now or old != History({})):
            self._records.put(assignment, student, history)
        if now or changes:
            self._stamp(student, assignment, history)

    def _stamp(self, student: str, assignment: str, history: History) -> None:
        """Write the time of handing in into nbgrader's timestamp file.

        If the time is unknown, remove the file, and the folders that are then empty.
        """
        stamp = self.directory.path / "submitted" / student / assignment / TIMESTAMP
        if history.when:
            text = f"{timestamp_text(history.when)}\n".encode()
            with contextlib.suppress(UnreadableSubmission):
                if read_bytes(stamp) == text:
                    return
            write_whole(stamp, text)
        elif stamp.parent.is_dir():
            stamp.unlink(missing_ok=True)
            with contextlib.suppress(OSError):  # a folder is not empty
                stamp.parent.rmdir()
                stamp.parent.parent.rmdir()


def _existing_content(path: Path) -> str:
    """Return the hash of the file at a path; empty if the file does not exist.

    Raises:
        UnreadableSubmission: The path is not an ordinary file, or a folder in it is a link.
    """
    for place in (path.parent.parent, path.parent, path):
        if place.is_symlink():
            raise UnreadableSubmission(f"{place} is a link: remove it")
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest() if path.exists() else ""
    except UnreadableSubmission as error:
        raise UnreadableSubmission(f"something else is at {path}: {error}") from error


def rename_decomposed_folders(directory: ClassDirectory) -> Iterator[str]:
    """Rename students' folders in whose names a Mac has stored accents as separate characters (Unicode NFD).

    Yield a sentence about each renamed folder. An instructor could not find the fault, because both forms of a name
    look the same.
    """
    for folder in _folders(directory.path / "submitted"):
        composed = folder.with_name(unicodedata.normalize("NFC", folder.name))
        if composed != folder and not composed.exists():
            with contextlib.suppress(OSError):
                folder.rename(composed)
                yield f"the folder {composed.name} was renamed: a Mac had stored its accents as separate characters"


def misplaced_files(directory: ClassDirectory) -> tuple[list[RefusedFile], list[str]]:
    """Find the notebooks and zips in ``submitted`` that are not graded.

    Returns two lists. The first has one such file of each folder whose notebook is missing or that should contain none.
    The second has a sentence for each folder that contains the right notebook, too.
    """
    submitted = directory.path / "submitted"
    notebooks = {name: directory.notebooks(name) for name in directory.assignments()}
    students = _folders(submitted)
    folders: list[tuple[Path, list[str]]] = [(one, []) for one in (submitted, *students)]
    submissions = [folder for student in students for folder in _folders(student) if folder.name in notebooks]
    folders += [(folder, notebooks[folder.name]) for folder in submissions]
    refused, notices = [], []
    for folder, names in folders:
        places = [folder / f"{name}{SUFFIX}" for name in names]
        others = [one for one in _entries(folder) if one.is_file() and not one.is_symlink()]
        others = [one for one in others if one.suffix.lower() in (SUFFIX, ".zip") and one not in places]
        if not others:
            continue
        more = f", nor are {len(others) - 1} more files in this folder" if others[1:] else ""
        missing = next((place for place in places if not place.exists()), None)
        if names and not missing:
            notices.append(
                f"{others[0].relative_to(submitted)} is not graded{more}: the notebook in the same folder is graded"
            )
            continue
        move = f"move the file into {submitted}/STUDENT/ASSIGNMENT"
        step = f"rename the notebook to grade to {missing}" if missing else move
        why = f"the file is not graded in this place{more}: {step}, or give the file to `{COMMAND} collect`"
        refused.append(RefusedFile(others[0], why))
    return refused, notices


def _folders(folder: Path) -> list[Path]:
    return [entry for entry in _entries(folder) if entry.is_dir() and not entry.is_symlink()]


def _entries(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    return []
