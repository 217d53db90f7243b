"""Reads the bytes of a submitted file, and defines the types of its parsed cells."""

from __future__ import annotations

import contextlib
import itertools
import os
import stat
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Annotated

import msgspec
import re2

from autograder.execution.executed_cells import IMAGES, CellType
from autograder.safe_files import files_below, opened

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


MAX_BYTES = 50_000_000
"""The maximum size of a file in bytes. A notebook with many pictures in its outputs has a few megabytes."""
MAX_CELLS = 2_000
MAX_CELL_CHARACTERS = 100_000
"""The maximum length of the text of one cell, in characters; students write a few thousand."""
MAX_CHARACTERS = 1_000_000
"""The maximum length of the text of all cells together, in characters."""
LONGEST_REASON = 300
"""The maximum length, in characters, of the desk's reason why a file cannot be read."""
LONGEST_NAME = 200
"""The maximum length of the name of a cell or picture, in characters."""
BASE64 = re2.compile(r"[A-Za-z0-9+/=\s]+")
_LONGEST_SHOWN = 80
_KINDS = {
    stat.S_ISLNK: "a link",
    stat.S_ISDIR: "a folder",
    stat.S_ISFIFO: "a pipe",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
}


class UnreadableSubmission(ValueError):
    """The submission cannot be read as a notebook. The message is a sentence for the student."""


_Name = Annotated[str, msgspec.Meta(max_length=LONGEST_NAME)]
Picture = tuple[_Name, str, str]


@dataclass(frozen=True)
class SubmittedCell:
    """The parts of a submitted cell that the grader uses.

    Attributes:
        kind: The type of the submitted cell.
        source: The text of the cell.
        grade_id: The name that the cell claims to have; empty if it has none.
        identifier: The id of the cell; empty if it has none.
        is_graded: True if the cell claims to have points. Trust this only in a source notebook.
        pictures: The bitmaps attached to a text cell, each with name, type and base64 content.
    """

    kind: CellType
    source: Annotated[str, msgspec.Meta(max_length=MAX_CELL_CHARACTERS)]
    grade_id: _Name = ""
    identifier: _Name = ""
    is_graded: bool = False
    pictures: tuple[Picture, ...] = ()


class ReadNotebook(msgspec.Struct, frozen=True, tag=True):
    """The desk's answer about a file that is a notebook.

    Attributes:
        left_out: The number of cells that were left out because they are not valid cells.
    """

    cells: Annotated[tuple[SubmittedCell, ...], msgspec.Meta(max_length=MAX_CELLS)]
    left_out: Annotated[int, msgspec.Meta(ge=0, le=MAX_CELLS)]

    def __post_init__(self) -> None:
        """Refuse cells that no notebook can bring about, also when msgspec decodes an answer.

        Raises:
            ValueError: The cells have too much text together, or a picture is not a bitmap.
        """
        pictures = (picture for cell in self.cells for picture in cell.pictures)
        if sum(len(cell.source) for cell in self.cells) > MAX_CHARACTERS or not all(
            kind in IMAGES and BASE64.fullmatch(data) for _, kind, data in pictures
        ):
            raise ValueError("no notebook has these cells")


class Unreadable(msgspec.Struct, frozen=True, tag=True):
    """The desk's answer about a file that is not a notebook.

    Attributes:
        reason: The reason, as a sentence for the student.
    """

    reason: Annotated[str, msgspec.Meta(min_length=1, max_length=LONGEST_REASON)]


class NotAFile(UnreadableSubmission):
    """The path of the notebook is not an ordinary file, or cannot be opened."""


def read_bytes(path: Path, most: int = MAX_BYTES) -> bytes:
    """Return the bytes of a submitted file.

    Args:
        path: The file's path.
        most: The maximum size in bytes.

    Raises:
        NotAFile: The path is a link, a pipe, a device or similar, or cannot be opened.
        UnreadableSubmission: The file is missing or too large.
    """
    with _opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > most:
            raise UnreadableSubmission(
                f"{_shown(path.name)} has {size / 1e6:.0f} MB; the limit is {most / 1e6:.0f} MB. "
                "Clear its outputs and hand it in again."
            )
        data = file.read(most + 1)
    if len(data) > most:
        raise UnreadableSubmission(f"{_shown(path.name)} became longer while it was read; hand it in again.")
    return data


def reason_against_file(path: Path) -> str:
    """Return why ``path`` cannot be a submission; empty if it is an ordinary file or does not exist."""
    try:
        with _opened(path):
            return ""
    except NotAFile as error:
        return str(error)
    except UnreadableSubmission:
        return ""


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[IO[bytes]]:
    """Open an ordinary file.

    The type of the file is checked before opening it, because opening a device may have effects; and again afterwards,
    because the file may have been replaced.
    """
    try:
        _check(path, path.lstat())
        with opened(path) as file:
            _check(path, os.fstat(file.fileno()))
            yield file
    except FileNotFoundError:
        raise UnreadableSubmission(
            f"The submission contains no notebook named {path.name}.{_found_instead(path.parent)}"
        ) from None
    except OSError as error:
        raise NotAFile(f"{_shown(path.name)} could not be read: {error.strerror}.") from None


def _check(path: Path, status: os.stat_result) -> None:
    for is_kind, name in _KINDS.items():
        if is_kind(status.st_mode):
            raise NotAFile(f"{_shown(path.name)} is {name}; hand in the notebook itself.")
    if not stat.S_ISREG(status.st_mode):
        raise NotAFile(f"{_shown(path.name)} is not a file; hand in the notebook itself.")
    if status.st_nlink > 1 and _is_another_students(path, status):
        raise NotAFile(
            f"{_shown(path.name)} is another student's file under a second name (a hard link); hand in your own."
        )


def _is_another_students(path: Path, status: os.stat_result) -> bool:
    """Return True if a file with several names (hard links) belongs to another student or to the class.

    The file belongs to the student whose folder has the oldest change time, which only the system can set. So a student
    cannot make another student's submission fail by making a link to it. Links outside the class are ignored, because a
    backup may have made them.
    """
    submitted = next((folder for folder in path.parents if folder.name == "submitted"), path.parent)
    places = itertools.chain(files_below(submitted), files_below(submitted.parent / "source"))
    alike = (place for place in places if place.suffix == path.suffix and place != path)
    names = [place for place in alike if _same_file(place, status)]
    first = min((name.parent.stat().st_ctime_ns for name in names), default=None)
    in_source = any("source" in name.relative_to(submitted.parent).parts[:1] for name in names)
    return in_source or (first is not None and first < path.parent.stat().st_ctime_ns)


def _same_file(place: Path, status: os.stat_result) -> bool:
    with contextlib.suppress(OSError):
        other = place.lstat()
        return (other.st_dev, other.st_ino) == (status.st_dev, status.st_ino)
    return False


def _found_instead(folder: Path) -> str:
    """Return a sentence about other notebooks in the folder, such as one whose name a browser changed."""
    try:
        others = sorted(entry.name for entry in os.scandir(folder) if entry.name.endswith(".ipynb"))
    except OSError:
        return ""
    return f" Found instead: {', '.join(map(_shown, others[:3]))}." if others else ""


def _shown(name: str) -> str:
    """Return a file name, which a student may have chosen, shortened and without unprintable characters."""
    name = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in name)
    return name if len(name) <= _LONGEST_SHOWN else f"{name[:_LONGEST_SHOWN]}…"
