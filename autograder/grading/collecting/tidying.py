"""Files a little beside their place in ``submitted``: moved there where that is certain, named where it is not."""

from __future__ import annotations

import contextlib
import unicodedata
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, Refused
from autograder.grading.collecting.assignment_of import notebooks_by_name
from autograder.grading.collecting.forms import base_and_number

if TYPE_CHECKING:
    from pathlib import Path


MOST_BESIDE = 50
"""Notebooks and archives beside their place in one folder that are looked at; a browser's copies are three or four."""


@dataclass
class Tidied:
    """The result of tidying.

    Attributes:
        notices: Sentences on what was put right, or is worth knowing.
        refused: Files that a person has to put right.
        waiting: Files that would be moved: the place of each, and the place where it belongs.
        moves: Whether anything is moved, or only found.
    """

    notices: list[str] = field(default_factory=list)
    refused: list[Refused] = field(default_factory=list)
    waiting: list[tuple[Path, Path]] = field(default_factory=list)
    moves: bool = True


def tidy(directory: ClassDirectory, *, moves: bool = True) -> Tidied:
    """Put notebooks and folders into their place: the content stays, and nothing is written over.

    Args:
        directory: The class, locked by this process.
        moves: Do it; without, only find out what would be done, for which nobody has to lock the class.
    """
    found = Tidied(moves=moves)
    submitted = directory.path / "submitted"
    notebooks = {name: directory.notebooks(name) for name in directory.assignments()}
    for entry in _entries(submitted):
        if _is_folder(entry):
            student = _composed(entry, found)
            _tidy_student(student, notebooks, found)
        elif _is_work(entry):
            found.refused.append(
                Refused(
                    entry,
                    f"whose it is cannot be seen: put it into {submitted}/<student>/<assignment>/, or hand it to "
                    "`./course collect`",
                )
            )
    alike = defaultdict(list)
    for entry in _entries(submitted):
        if _is_folder(entry):
            alike[unicodedata.normalize("NFC", entry.name).casefold()].append(entry.name)
    found.notices += [
        f"{' and '.join(names)} are two students, told apart by capitals alone"
        for names in alike.values()
        if names[1:]
    ]
    return found


def _composed(folder: Path, found: Tidied) -> Path:
    """A name as everybody else writes it: a Mac stores é as e and an accent."""
    composed = folder.with_name(unicodedata.normalize("NFC", folder.name))
    if composed.name == folder.name or not found.moves:
        return folder
    if composed.exists():
        found.refused.append(
            Refused(
                folder,
                f"its letters are in decomposed form, and {composed.name} is there, too: put them together",
            )
        )
        return folder
    with contextlib.suppress(OSError):
        folder.rename(composed)
        found.notices.append(f"the folder {composed.name} was renamed: its letters were in decomposed form")
        return composed
    return folder


def _tidy_student(student: Path, notebooks: dict[str, list[str]], found: Tidied) -> None:
    targets = notebooks_by_name(notebooks)
    entries = _entries(student)
    for entry in entries:
        if entry.name in notebooks and _is_folder(entry):
            _tidy_assignment(entry, notebooks[entry.name], found)
    for entry in _first(list(filter(_is_work, entries)), found):
        meant = targets.get(base_and_number(entry.stem)[0].casefold(), [])
        place = student / meant[0][0] / f"{meant[0][1]}{SUFFIX}" if len(meant) == 1 else None
        # A link in the folder's place may lead to somebody else's; that it is one is said of it.
        if place is None or place.parent.is_symlink() or place.exists() or entry.suffix.lower() != SUFFIX:
            beside = f"; {place} is graded" if place and place.exists() else ""
            found.refused.append(
                Refused(
                    entry,
                    f"it lies one folder too high, where nothing is graded{beside}: move it, or remove it",
                )
            )
        else:
            _move(entry, place, found)


def _tidy_assignment(folder: Path, names: list[str], found: Tidied) -> None:
    expected = {name.casefold(): name for name in names}
    others = [
        entry
        for entry in _entries(folder)
        if _is_work(entry) and not (entry.suffix == SUFFIX and entry.stem in names)
    ]
    bases = {entry: base_and_number(entry.stem)[0].casefold() for entry in others}
    alike = Counter(bases.values())
    for entry in _first(others, found):
        name = expected.get(bases[entry])
        place = folder / f"{name}{SUFFIX}"
        label = f"{folder.parent.name}/{folder.name}/{entry.name}"
        if name and entry.suffix.lower() == SUFFIX and not place.exists() and alike[bases[entry]] == 1:
            _move(entry, place, found)
        elif (name and place.exists()) or (
            not name and all((folder / f"{one}{SUFFIX}").exists() for one in names)
        ):
            found.notices.append(
                f"{label} was left out: the notebook beside it is graded; to let this one count, put it there"
            )
        elif name or entry.suffix.lower() == ".zip":
            found.refused.append(Refused(entry, f"it is not graded: put the notebook that counts at {place}"))


def _first(entries: list[Path], found: Tidied) -> list[Path]:
    """As many of the entries of a folder as anybody wants to read of."""
    if more := entries[MOST_BESIDE:]:
        where = f"{more[0].parent.parent.name}/{more[0].parent.name}"
        found.notices.append(f"{where} has {len(more)} more notebooks and archives, which were not looked at")
    return entries[:MOST_BESIDE]


def _move(entry: Path, place: Path, found: Tidied) -> None:
    label = f"{place.parent.parent.name}/{place.parent.name}/{place.name}"
    if not found.moves:
        found.waiting.append((entry, place))
        return
    try:
        place.parent.mkdir(exist_ok=True)
        entry.rename(place)
    except OSError as error:
        found.refused.append(Refused(entry, f"it belongs at {place} and cannot be moved: {error.strerror}"))
    else:
        found.notices.append(f"{label} was called {entry.relative_to(place.parent.parent)} and is graded")


def _entries(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    return []


def _is_folder(entry: Path) -> bool:
    return entry.is_dir() and not entry.is_symlink()


def _is_work(entry: Path) -> bool:
    return entry.is_file() and not entry.is_symlink() and entry.suffix.lower() in (SUFFIX, ".zip")
