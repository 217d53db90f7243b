"""The rules for what lies in ``submitted``: the names of folders, and which files are refused."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.rebuilding.submitted_notebook import reason_against_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

_LONGEST_NAME = 100


@dataclass(frozen=True)
class RefusedFile:
    """A file or folder in ``submitted`` that cannot be graded.

    Attributes:
        path: The file or folder.
        reason: The reason, and what the instructor has to do.
        waits: True if it is a collected file that waits for the instructor.
    """

    path: Path
    reason: str
    waits: bool = False


def reason_against_name(name: str) -> str:
    """Return why the name of a folder cannot be a student's id; empty if it can.

    For example, ``*`` is not allowed, because nbgrader uses the name in search patterns and would find another
    student's folder or none. Control characters are not allowed, because with them a student could forge lines in a
    terminal or log.
    """
    if len(name.encode("utf-8", "surrogateescape")) > _LONGEST_NAME:
        return f"the name is longer than {_LONGEST_NAME} bytes"
    if any(not (character.isalnum() or character in " ._-@+'") for character in name):
        return "the name has characters other than letters, digits, spaces and . _ - @ + '"
    if not name or name.startswith("."):
        return "the name is empty or begins with a dot"
    if name != name.strip() or name != unicodedata.normalize("NFC", name):
        return "the name begins or ends with a space, or has accents as separate characters (Unicode NFD)"
    return ""


def odd_files(paths: Iterable[Path]) -> Iterator[RefusedFile]:
    """Yield the notebooks that cannot be read as files, each with the reason."""
    for path in paths:
        reason = reason_against_file(path)
        if reason:
            yield RefusedFile(path, reason)


def folders_in(parent: Path, refused: list[RefusedFile]) -> list[Path]:
    """Return the folders in ``parent`` with usable names, and add other folders and special files to ``refused``."""
    folders = []
    for entry in _entries(parent, refused):
        if entry.name.startswith("."):
            continue
        if entry.is_symlink():
            refused.append(RefusedFile(entry, "the path is a link; replace the link by the folder"))
        elif entry.is_dir():
            reason = reason_against_name(entry.name)
            if reason:
                refused.append(RefusedFile(entry, f"{reason}; rename the folder"))
            else:
                folders.append(entry)
        elif not entry.is_file():
            refused.append(RefusedFile(entry, "the path is neither a folder nor a file; remove it"))
    return folders


def _entries(parent: Path, refused: list[RefusedFile]) -> list[Path]:
    try:
        return sorted(parent.iterdir())
    except FileNotFoundError:
        return []
    except OSError as error:
        refused.append(RefusedFile(parent, f"the folder could not be read: {error.strerror}"))
        return []
