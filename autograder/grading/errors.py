"""Errors about a class, with advice for instructors. They end the command line with exit code 2."""

from __future__ import annotations

import contextlib
import errno
import shlex
from typing import TYPE_CHECKING

from environment.installation import COMMAND, IS_CLONE, ROOT, installing

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path


def course_command(*words: object, inside: Path | None = None) -> str:
    """Return a command as messages show it, quoted so that a shell takes each word as one, even a path with spaces.

    Args:
        words: The words after ``./course`` (after ``autograder`` if the wheel is installed).
        inside: The folder in which the command has to be typed, which nbgrader's own commands require; None for any
            folder.
    """
    program = ROOT / COMMAND if inside and IS_CLONE else COMMAND
    command = shlex.join(map(str, (program, *words)))
    return f"{shlex.join(['cd', str(inside)])} && {command}" if inside else command


class GradingError(Exception):
    """A problem that an instructor can fix. The message says what happened and what to do."""


def check_known(wanted: Sequence[str], known: Sequence[str], what: str) -> None:
    """Check that every chosen name exists.

    Raises:
        GradingError: A name does not exist. The message lists the names that do.
    """
    for name in wanted:
        if name not in known:
            raise GradingError(
                f"There is no {what} named {name} here. There is: {', '.join(known) or 'none'}."
            )


class NotAClass(GradingError):
    """The folder is not a class directory."""

    def __init__(self, path: Path, missing: str) -> None:
        super().__init__(
            f"{path} is not a class directory: {missing}. "
            f"Name the folder that `{COMMAND} new-class` made, or make one: {course_command('new-class', path)}"
        )


class ClassExists(GradingError):
    """A class cannot be made in a folder that is not empty."""


class ClassIncomplete(GradingError):
    """The class directory lacks something that grading needs, or two parts of it contradict each other."""


class ClassBusy(GradingError):
    """Another batch is running on this class.

    Args:
        path: The class.
        holder: The process that runs the other batch; empty if unknown.
    """

    def __init__(self, path: Path, holder: str) -> None:
        super().__init__(
            f"Another grading run is at work in {path}{f' ({holder})' if holder else ''}. "
            "Wait until it has ended, or stop it; what it has graded so far is kept."
        )


class MasterUnusable(GradingError):
    """Submissions cannot be graded against this source notebook of the class."""


class DiskFull(GradingError):
    """The disk is full."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"The disk that holds {path} is full. Free some room and run the same command again: "
            "what was graded so far is kept, and no grade of an earlier run is shown instead."
        )


class GradebookTrouble(GradingError):
    """The gradebook cannot be read or written.

    Args:
        path: The class.
        said: The error message of the database.
    """

    def __init__(self, path: Path, said: str) -> None:
        advice = next(
            (words for sign, words in _GRADEBOOK_ADVICE.items() if sign in said),
            "Check that it exists and is not damaged; nbgrader keeps no copy of it, your backup does.",
        )
        super().__init__(
            f"The gradebook of {path} cannot be read or written ({said}). {advice} What was graded so far is "
            "kept; no student has points that were not earned."
        )


class StoreTrouble(GradingError):
    """The store of a class cannot be read or written.

    Args:
        file: The file of the store.
        said: The reason, for example the message of the database.
    """

    def __init__(self, file: Path, said: str) -> None:
        advice = next(
            (words for sign, words in _STORE_ADVICE.items() if sign in said), _STORE_ADVICE["malformed"]
        )
        super().__init__(
            f"{file}, which holds what was graded, cannot be read or written ({said}). {advice} The gradebook is not "
            "touched by that, and no student has points that were not earned."
        )


_GRADEBOOK_ADVICE = {
    "locked": "Another program has the file open for writing: close it, and run the same command again.",
    "readonly": "Check the owner and the mode of the file and of its folder; then run the same command again.",
    "not a database": "Restore a backup of the file; the next run enters all grades again.",
    "malformed": "Restore a backup of the file; the next run enters all grades again.",
    "connection": "Check that the database server runs, and that its address and your access rights are correct.",
}

_STORE_ADVICE = {
    "locked": _GRADEBOOK_ADVICE["locked"],
    "readonly": _GRADEBOOK_ADVICE["readonly"],
    "unable to open": _GRADEBOOK_ADVICE["readonly"],
    "disk I/O error": "Check your quota and the health of the disk; then run the same command again.",
    "newer course": "The file is not damaged. Use the version of the course that wrote it, or a newer one.",
    "malformed": "Restore a backup of the file. Without a backup, rename it: the next run grades everything again, and "
    "the notes of earlier attempts, runs and appeals stay in the renamed file only.",
}


def is_disk_full(error: BaseException | None) -> bool:
    """Return True if ``error`` was caused by a full disk or an exhausted quota."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            return True
        if "disk is full" in str(error) and type(error).__module__.startswith(("sqlite3", "sqlalchemy")):
            return True
        error = error.__cause__ or error.__context__
    return False


@contextlib.contextmanager
def clear_disk_errors(path: Path) -> Iterator[None]:
    """Turn errors of the disk and the database in the block into messages for an instructor.

    Args:
        path: The class that is in use.

    Raises:
        DiskFull: The disk is full, whichever step noticed it.
        GradebookTrouble: The gradebook is locked, read-only, damaged or out of reach.
        GradingError: A file may not be read or written.
    """
    try:
        yield
    except GradingError:
        raise
    except Exception as error:
        if is_disk_full(error):
            raise DiskFull(path) from error
        if isinstance(error, ModuleNotFoundError) and str(error.name).startswith("psycopg"):
            raise GradingError(
                f"The gradebook of {path} is in PostgreSQL, and the library to connect to it is not "
                f"installed here. Type: {installing('postgresql', clone='--with postgresql')}"
            ) from error
        said = said_by_database(error)
        if said:
            raise GradebookTrouble(path, said) from error
        if isinstance(error, PermissionError):
            raise GradingError(
                f"{error.filename or path} may not be read or written by you. Look at its owner and its mode."
            ) from error
        raise


@contextlib.contextmanager
def clear_place_errors(path: Path, option: str) -> Iterator[None]:
    """Turn errors about the path of a requested output file into messages for an instructor.

    Args:
        path: The file to write.
        option: The command's option with which another path can be given.

    Raises:
        GradingError: A file or folder is in the way, or the name is not allowed.
        OSError: The disk failed; :func:`clear_disk_errors` has messages for that.
    """
    try:
        yield
    except OSError as error:
        if is_disk_full(error) or isinstance(error, PermissionError):
            raise
        reason = f"{path} cannot be written: {error.strerror}"
        if isinstance(error, IsADirectoryError):
            reason = f"{path} is a folder, but a file has to be written there"
        elif isinstance(error, FileExistsError | NotADirectoryError):
            in_the_way = [one for one in path.parents if one.exists() and not one.is_dir()]
            reason = f"{in_the_way[0]} is not a folder" if in_the_way else reason
        raise GradingError(f"{reason}. Name another place: {option}") from error


def said_by_database(error: BaseException | None) -> str:
    """Return the message of the database error behind ``error``; empty if there is none."""
    while error is not None:
        if type(error).__module__.startswith(("sqlite3", "sqlalchemy")):
            return " ".join(str(getattr(error, "orig", None) or error).split())[:200]
        error = error.__cause__ or error.__context__
    return ""
