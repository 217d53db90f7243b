"""Finds notebooks in ``submitted`` that ``grade`` does not grade, because their folder or their name is wrong."""

from __future__ import annotations

import contextlib
import unicodedata
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, RefusedFile
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


def put_right(directory: ClassDirectory) -> Iterator[str]:
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


def beside_their_place(directory: ClassDirectory) -> tuple[list[RefusedFile], list[str]]:
    """Find the notebooks and zips in ``submitted`` that are not graded.

    Returns two lists. The first has one such file of each folder whose notebook is missing or that should contain none.
    The second has a sentence for each folder that contains the right notebook, too.
    """
    submitted = directory.path / "submitted"
    notebooks = {name: directory.notebooks(name) for name in directory.assignments()}
    students = _folders(submitted)
    folders: list[tuple[Path, list[str]]] = [(one, []) for one in (submitted, *students)]
    folders += [
        (folder, notebooks[folder.name])
        for student in students
        for folder in _folders(student)
        if folder.name in notebooks
    ]
    refused, notices = [], []
    for folder, names in folders:
        places = [folder / f"{name}{SUFFIX}" for name in names]
        others = [
            one for one in _entries(folder) if one.suffix.lower() in (SUFFIX, ".zip") and one not in places
        ]
        others = [one for one in others if one.is_file() and not one.is_symlink()]
        if not others:
            continue
        more = f", nor are {len(others) - 1} more files in this folder" if others[1:] else ""
        missing = next((place for place in places if not place.exists()), None)
        if names and not missing:
            notices.append(
                f"{others[0].relative_to(submitted)} is not graded{more}: the notebook in the same folder is graded"
            )
            continue
        place = (
            f"rename the notebook to grade to {missing}"
            if missing
            else f"move the file into {submitted}/STUDENT/ASSIGNMENT"
        )
        refused.append(
            RefusedFile(
                others[0],
                f"the file is not graded in this place{more}: {place}, or give the file to `{COMMAND} collect`",
            )
        )
    return refused, notices


def _folders(folder: Path) -> list[Path]:
    return [entry for entry in _entries(folder) if entry.is_dir() and not entry.is_symlink()]


def _entries(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    return []
