"""Notebooks in ``submitted`` that are not at their right path: some are renamed, the others are reported."""

from __future__ import annotations

import contextlib
import unicodedata
from collections import defaultdict
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, RefusedFile
from autograder.grading.collecting.reading.lms_file_names import base_and_number
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Container, Iterator
    from pathlib import Path


def put_right(directory: ClassDirectory) -> Iterator[str]:
    """Rename what can be renamed without asking, and yield a sentence about each.

    Two things are renamed: a student's folder whose accents a Mac has stored in decomposed form, because both names
    look the same; and the only notebook of a folder, if a browser has added a number to its name.
    """
    for folder in _folders(directory.path / "submitted"):
        composed = folder.with_name(unicodedata.normalize("NFC", folder.name))
        if composed != folder and _rename(folder, composed):
            yield f"the folder {composed.name} was renamed: its letters were in decomposed form"
    for folder, places in _of_assignments(directory):
        others = _work(folder, places)
        for place in places:
            is_it = len(places) == len(others) == 1 and others[0].suffix.lower() == SUFFIX
            if is_it and base_and_number(others[0].stem)[0].casefold() == place.stem.casefold():
                label = f"{folder.parent.name}/{folder.name}/{place.name}"
                if _rename(others[0], place):
                    yield f"{label} was called {others[0].name} and is graded"


def beside_their_place(directory: ClassDirectory) -> tuple[list[RefusedFile], list[str]]:
    """Return the files that a person has to move, at most one for each folder, and sentences for the instructor."""
    submitted = directory.path / "submitted"
    refused = _refused(
        submitted, f"put it into {submitted}/STUDENT/ASSIGNMENT, or hand it to `{COMMAND} collect`"
    )
    notices, alike = [], defaultdict(list)
    for student in _folders(submitted):
        alike[student.name.casefold()].append(student.name)
        refused += _refused(student, f"move it into {student}/ASSIGNMENT, or remove it")
    for folder, places in _of_assignments(directory):
        others = _work(folder, places)
        if missing := [place for place in places if not place.exists()]:
            refused += _refused(folder, f"put the notebook that counts at {missing[0]}", places)
        elif others:
            label = f"{folder.parent.name}/{folder.name}/{others[0].name}"
            more = f" and {len(others) - 1} more are" if others[1:] else " is"
            notices.append(f"{label}{more} left out: the notebook in the same folder is graded")
    notices += [
        f"{' and '.join(names)} are two students whose ids differ only in capital letters"
        for names in alike.values()
        if names[1:]
    ]
    return refused, notices


def _of_assignments(directory: ClassDirectory) -> Iterator[tuple[Path, list[Path]]]:
    """Yield the folder of each submission, with the paths at which its notebooks should be."""
    notebooks = {name: directory.notebooks(name) for name in directory.assignments()}
    for student in _folders(directory.path / "submitted"):
        for folder in _folders(student):
            if folder.name in notebooks:
                yield folder, [folder / f"{name}{SUFFIX}" for name in notebooks[folder.name]]


def _refused(folder: Path, what_to_do: str, places: Container[Path] = ()) -> list[RefusedFile]:
    """Return one refusal for all notebooks and archives of a folder that are at wrong paths; none if there are none."""
    others = _work(folder, places)
    more = f", nor are {len(others) - 1} more files here" if others[1:] else ""
    return [RefusedFile(others[0], f"it is not graded in this place{more}: {what_to_do}")] if others else []


def _rename(entry: Path, place: Path) -> bool:
    with contextlib.suppress(OSError):
        if not place.exists() and not place.is_symlink():
            entry.rename(place)
            return True
    return False


def _work(folder: Path, places: Container[Path]) -> list[Path]:
    return [
        entry
        for entry in _entries(folder)
        if entry.suffix.lower() in (SUFFIX, ".zip")
        and entry.is_file()
        and not entry.is_symlink()
        and entry not in places
    ]


def _folders(folder: Path) -> list[Path]:
    return [entry for entry in _entries(folder) if entry.is_dir() and not entry.is_symlink()]


def _entries(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    return []
