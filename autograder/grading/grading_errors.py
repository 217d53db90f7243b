"""Errors about a class, at which commands end with exit code 2. Their messages tell an instructor what to do."""

from __future__ import annotations

import contextlib
import errno
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.command_name import COMMAND
from autograder.safe_files import write_whole
from course_runtime.installation import IS_CLONE, ROOT, installing

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator


def course_command(*words: object, inside: Path | None = None) -> str:
    """Return a command for a message, quoted so that an instructor can paste it into a shell.

    Args:
        words: The words after ``./course`` (or after ``autograder``, if the wheel is installed).
        inside: The folder in which the command must run, as nbgrader's commands require; None for any folder.
    """
    program = ROOT / COMMAND if inside and IS_CLONE else COMMAND
    # In the folder of the class, the class need not be named.
    here = [word for word in words if not (isinstance(word, Path) and word.absolute() == Path.cwd())]
    command = shlex.join(map(str, (program, *here)))
    return f"{shlex.join(['cd', str(inside)])} && {command}" if inside else command


class GradingError(Exception):
    """A problem that an instructor can fix. The message says what happened and what to do."""


def check_known(wanted: Iterable[str], known: Collection[str], what: str) -> None:
    """Check that every chosen name exists.

    Raises:
        GradingError: A name does not exist. The message lists the names that exist.
    """
    for name in wanted:
        if name not in known:
            raise GradingError(f"No {what} is named {name}. Known names: {', '.join(known) or 'none'}.")


class NotAClass(GradingError):
    """The folder is not a class directory."""

    def __init__(self, path: Path, missing: str) -> None:
        super().__init__(
            f"{path} is not a class directory: {missing}. "
            f"Use the folder that `{COMMAND} new-class` made, or make a class: {course_command('new-class', path)}"
        )


class ClassBusy(GradingError):
    """Another process is grading the class.

    Args:
        path: The class.
        holder: A description of the other process; empty if unknown.
    """

    def __init__(self, path: Path, holder: str) -> None:
        super().__init__(
            f"Another run is grading {path}{f' ({holder})' if holder else ''}. "
            "Wait until it ends, or stop it; its finished grades are stored."
        )


class MasterUnusable(GradingError):
    """A source notebook of the class cannot be used for grading."""


class DiskFull(GradingError):
    """The disk is full."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"The disk with {path} is full. Free some space and type the same command again: "
            "finished grades are stored, and the gradebook has no outdated grades."
        )


class GradebookTrouble(GradingError):
    """The gradebook cannot be read or written.

    Args:
        path: The class.
        said: The database's error message.
    """

    def __init__(self, path: Path, said: str) -> None:
        advice = next(
            (words for sign, words in _GRADEBOOK_ADVICE.items() if sign in said),
            "Check that the file exists and is not damaged. If it is damaged, restore your backup: nbgrader "
            "makes none.",
        )
        super().__init__(
            f"The gradebook of {path} cannot be read or written ({said}). {advice} Finished grades are "
            "stored, and no student has points without having earned them."
        )


class StoreTrouble(GradingError):
    """The store of a class cannot be read or written.

    Args:
        file: The file of the store.
        said: The reason, for example the database's error message.
    """

    def __init__(self, file: Path, said: str) -> None:
        advice = next(
            (words for sign, words in _STORE_ADVICE.items() if sign in said), _STORE_ADVICE["malformed"]
        )
        super().__init__(
            f"{file}, which contains the results of grading, cannot be read or written ({said}). {advice} The "
            "gradebook is unchanged, and no student has points without having earned them."
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
    "malformed": "Restore a backup of the file. Without a backup, rename the file: the next run then grades everything "
    "again, but without the records of earlier attempts, runs and appeals.",
}


def is_disk_full(error: BaseException | None) -> bool:
    """Return True if ``error`` was caused by a full disk or an exhausted quota."""
    return any(
        one.errno in (errno.ENOSPC, errno.EDQUOT) if isinstance(one, OSError) else "disk is full" in said
        for one, said in _causes(error)
    )


@contextlib.contextmanager
def clear_disk_errors(path: Path) -> Iterator[None]:
    """If the disk or the database fails in the block, raise an error with a message for an instructor.

    Args:
        path: The class that is in use.

    Raises:
        DiskFull: The disk is full.
        GradebookTrouble: The gradebook is locked, read-only, damaged or out of reach.
        GradingError: A file may not be read or written.
    """
    try:
        yield
    except GradingError:
        raise
    except Exception as error:
        # The order matters: SQLite and SQLAlchemy report a full disk as a database error, too.
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
        if isinstance(error, OSError) and error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
            raise GradingError(
                f"You do not have the right to read or write {error.filename or path}: {error.strerror}. Check its "
                "owner, its mode, and whether its disk is mounted for reading only."
            ) from error
        raise


def write_output(path: Path, data: bytes, option: str) -> None:
    """Write a file at a path that an instructor chose.

    Args:
        path: The file to write.
        option: The command's option for the path, which the message names.

    Raises:
        GradingError: The path is a folder or lies below a file, or its name is not allowed.
        OSError: The disk failed; :func:`clear_disk_errors` has messages for that.
    """
    try:
        write_whole(path, data)
    except OSError as error:
        if is_disk_full(error) or isinstance(error, PermissionError):
            raise
        reason = f"{path} cannot be written: {error.strerror}"
        if isinstance(error, IsADirectoryError):
            reason = f"{path} is a folder, so no file can be written there"
        elif isinstance(error, FileExistsError | NotADirectoryError):
            in_the_way = [one for one in path.parents if one.exists() and not one.is_dir()]
            reason = f"{in_the_way[0]} is not a folder" if in_the_way else reason
        raise GradingError(f"{reason}. Choose another path: {option}") from error


def said_by_database(error: BaseException | None) -> str:
    """Return the database's message if a database error caused ``error``; empty if not."""
    return next((said[:200] for _, said in _causes(error) if said), "")


def _causes(error: BaseException | None) -> Iterator[tuple[BaseException, str]]:
    """Yield an error and the errors that caused it, each with its text if a database raised it, else with no text."""
    while error is not None:
        is_of_database = type(error).__module__.startswith(("sqlite3", "sqlalchemy"))
        yield error, " ".join(str(getattr(error, "orig", None) or error).split()) if is_of_database else ""
        error = error.__cause__ or error.__context__
