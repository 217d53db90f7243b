"""Reading what a student handed in, believing nothing but the text of the cells."""

from __future__ import annotations

import contextlib
import gc
import itertools
import json
import os
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any

import re2

from autograder.boxes.execution import CellType
from autograder.boxes.outputs import IMAGES
from autograder.regular_files import files_below, opened

if TYPE_CHECKING:
    from pathlib import Path

MAX_BYTES = 50_000_000
"""A notebook with many pictures in its outputs has a few megabytes."""
MAX_VALUES = 3_000_000
"""Lists, objects and the values in them, each of which takes some fifty bytes of memory; a picture is a single text."""
MAX_CELLS = 2_000
MAX_CELL_CHARACTERS = 100_000
"""Of one cell; what students write has a few thousand."""
MAX_CHARACTERS = 1_000_000
"""Of all cells together."""
HARMLESS_LENGTH = 6_000
"""Of a notebook's own cells that become a page without a trial: the worst of them take less than a page's budget."""
_QUOTED = re2.compile(r'(?s)"(?:[^"\\]|\\.)*"')
"""A text in JSON."""
_BASE64 = re2.compile(r"[A-Za-z0-9+/=\s]+")
_LONGEST_SHOWN = 80
_CELL_TYPES = tuple(CellType)
_KINDS = {
    stat.S_ISLNK: "a link",
    stat.S_ISDIR: "a folder",
    stat.S_ISFIFO: "a pipe",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
}


class UnreadableSubmission(ValueError):
    """The submission cannot be taken as a notebook; the message is a sentence for the student."""


Picture = tuple[str, str, str]


@dataclass(frozen=True)
class SubmittedCell:
    """All that is taken over from a submitted cell.

    Attributes:
        kind: The cell's type as it was submitted.
        source: Its text.
        grade_id: The name it claims to have, empty for none.
        identifier: Its id, empty for none.
        is_graded: Whether it claims to carry points; believed only of a source.
        pictures: The bitmaps attached to a text cell: name, type and contents as base64.
    """

    kind: CellType
    source: str
    grade_id: str = ""
    identifier: str = ""
    is_graded: bool = False
    pictures: tuple[Picture, ...] = ()


class NotAFile(UnreadableSubmission):
    """The notebook is not an ordinary file, or cannot be read."""


def read_bytes(path: Path, most: int = MAX_BYTES) -> bytes:
    """The bytes of a submitted file.

    Args:
        path: The file's path.
        most: Bytes that it may have.

    Raises:
        NotAFile: It is a link, a pipe, a device or the like, or cannot be opened.
        UnreadableSubmission: It is missing or too large.
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
        raise UnreadableSubmission(f"{_shown(path.name)} grows while it is read; hand it in again.")
    return data


def reason_against_file(path: Path) -> str:
    """Return why ``path`` cannot be a submission; empty for an ordinary file or if nothing exists there."""
    try:
        with _opened(path):
            return ""
    except NotAFile as error:
        return str(error)
    except UnreadableSubmission:
        return ""


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[IO[bytes]]:
    """An ordinary file, open. It is looked at before (to open a device may do something) and after."""
    try:
        _check(path, path.lstat())
        with opened(path) as file:
            _check(path, os.fstat(file.fileno()))
            yield file
    except FileNotFoundError:
        raise UnreadableSubmission(
            f"There is no notebook named {path.name} in the submission.{_found_instead(path.parent)}"
        ) from None
    except OSError as error:
        raise NotAFile(f"{_shown(path.name)} could not be read: {error.strerror}.") from None


def _check(path: Path, status: os.stat_result) -> None:
    for is_kind, name in _KINDS.items():
        if is_kind(status.st_mode):
            raise NotAFile(f"{_shown(path.name)} is {name}; hand in the notebook itself.")
    if not stat.S_ISREG(status.st_mode):
        raise NotAFile(f"{_shown(path.name)} is not a file; hand in the notebook itself.")
    if status.st_nlink > 1 and _is_somebody_elses(path, status):
        raise NotAFile(
            f"{_shown(path.name)} is another student's file under a second name (a hard link); hand in your own."
        )


def _is_somebody_elses(path: Path, status: os.stat_result) -> bool:
    """True if a file of several names was in another place of the class first.

    The first owner keeps the file, so that a student cannot get another student's work refused by giving it a second
    name. Only the system sets a folder's time of change, when a name is made in it. Names outside of
    the class are a backup's.
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
    """Other notebooks in a folder: mostly, a browser has numbered the name."""
    try:
        others = sorted(entry.name for entry in os.scandir(folder) if entry.name.endswith(".ipynb"))
    except OSError:
        return ""
    return f" Found instead: {', '.join(map(_shown, others[:3]))}." if others else ""


def _shown(name: str) -> str:
    """A file's name as it can be in any text: a student chose it, or a program that a student wrote."""
    name = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in name)
    return name if len(name) <= _LONGEST_SHOWN else f"{name[:_LONGEST_SHOWN]}…"


def parse(data: bytes) -> tuple[list[SubmittedCell], int]:
    """The cells of a submitted notebook.

    Returns:
        The cells, and the number of those that were left out because they had not the form of a cell.

    Raises:
        UnreadableSubmission: The file is not a notebook.
    """
    notebook = _decoded(data)
    if not isinstance(notebook, Mapping) or not isinstance(notebook.get("nbformat"), int):
        raise UnreadableSubmission("The file is JSON, but not a Jupyter notebook.")
    cells = _raw_cells(notebook)
    if len(cells) > MAX_CELLS:
        raise UnreadableSubmission(f"The notebook has {len(cells)} cells; the limit is {MAX_CELLS}.")
    taken = [cell for cell in map(_cell, cells) if cell is not None]
    characters = sum(len(cell.source) for cell in taken)
    if characters > MAX_CHARACTERS:
        raise UnreadableSubmission(
            f"The cells of the notebook have {characters} characters; the limit is {MAX_CHARACTERS}."
        )
    return taken, len(cells) - len(taken)


@contextlib.contextmanager
def without_garbage_collection() -> Iterator[None]:
    """Collect no garbage meanwhile: each collection would go through all objects of the process."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def why_unreadable(data: bytes) -> str:
    """Return the reason why these bytes cannot be taken as a notebook, for the student; empty if they can be."""
    try:
        parse(data)
    except UnreadableSubmission as error:
        return str(error)
    return ""


def _decoded(data: bytes) -> Any:
    if not data.strip(b"\0 \t\r\n"):
        raise UnreadableSubmission(
            f"The file is empty: {len(data)} bytes, and no text. Save the notebook in JupyterLab and hand in that file."
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not UTF-8 text (byte {error.start}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None
    # A quoted string counts once, even if it contains a million printed numbers.
    if _values(text) > MAX_VALUES and _values(_QUOTED.sub("", text)) > MAX_VALUES:
        raise UnreadableSubmission(
            f"The file has more than {MAX_VALUES:,} values, far more than a notebook has."
        )
    try:
        # Nothing that is made here can be freed, but the collector would look for it again and again.
        with without_garbage_collection():
            return json.loads(text)
    except (RecursionError, MemoryError):
        raise UnreadableSubmission("The file is not a notebook: its JSON is nested too deeply.") from None
    except ValueError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not JSON ({error}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None


def _values(text: str) -> int:
    return sum(map(text.count, "[{,"))


def _raw_cells(notebook: Mapping[str, Any]) -> list[Any]:
    if notebook["nbformat"] == 3 and isinstance(notebook.get("worksheets"), list):
        sheets = [sheet.get("cells") for sheet in notebook["worksheets"] if isinstance(sheet, Mapping)]
        return [_from_version_3(cell) for cells in sheets if isinstance(cells, list) for cell in cells]
    cells = notebook.get("cells")
    if notebook["nbformat"] != 4 or not isinstance(cells, list):
        raise UnreadableSubmission(
            f"This is not a notebook of format 4 (the file says format {str(notebook['nbformat'])[:20]})."
        )
    return cells


def _from_version_3(cell: Any) -> Any:
    if not isinstance(cell, Mapping):
        return cell
    return {**cell, "source": cell.get("input", cell.get("source"))}


def _cell(cell: Any) -> SubmittedCell | None:
    if not isinstance(cell, Mapping) or cell.get("cell_type") not in _CELL_TYPES:
        return None
    source = cell.get("source")
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    if not isinstance(source, str) or len(source) > MAX_CELL_CHARACTERS:
        return None
    metadata = cell.get("metadata")
    marks = metadata.get("nbgrader") if isinstance(metadata, Mapping) else None
    marks = marks if isinstance(marks, Mapping) else {}
    return SubmittedCell(
        CellType(cell["cell_type"]),
        _text(source),
        _name(marks.get("grade_id")),
        _name(cell.get("id")),
        marks.get("grade") is True,
        tuple(_pictures(cell)),
    )


def _pictures(cell: Mapping[str, Any]) -> Iterator[Picture]:
    """The attached bitmaps; a drawing that may hold a script is none of them."""
    attached = cell.get("attachments")
    for name, kinds in attached.items() if isinstance(attached, Mapping) else ():
        for kind in IMAGES if isinstance(kinds, Mapping) else ():
            data = kinds.get(kind)
            data = "".join(data) if isinstance(data, list) and all(isinstance(x, str) for x in data) else data
            if isinstance(data, str) and _BASE64.fullmatch(data):
                yield _name(name), kind, data
                break


def _name(value: Any) -> str:
    return _text(value)[:200] if isinstance(value, str) else ""


def _text(value: str) -> str:
    """A text that can be written to a file: a lone surrogate is legal JSON, but it has no UTF-8."""
    return value.encode("utf-8", "replace").decode("utf-8")
