"""What can be wrong with a class, and what to do. The command line ends with exit code 2 on these."""

from __future__ import annotations

import contextlib
import errno
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class GradingError(Exception):
    """Something an instructor can put right; the message says what happened and what to do."""


class NotAClass(GradingError):
    """The folder is no class directory."""

    def __init__(self, path: Path, missing: str) -> None:
        super().__init__(
            f"{path} is not a class directory: {missing}. "
            f"Name the folder that `autograder new-class` made, or make one: autograder new-class {path}"
        )


class ClassExists(GradingError):
    """A class cannot be made where something is already."""


class ClassIncomplete(GradingError):
    """The class directory lacks something that grading needs, or two parts of it contradict each other."""


class ClassBusy(GradingError):
    """Another batch is running on this class.

    Args:
        path: The class.
        holder: Who runs it; empty where that is not known.
    """

    def __init__(self, path: Path, holder: str) -> None:
        super().__init__(
            f"Another grading run is at work in {path}{f' ({holder})' if holder else ''}. "
            "Wait until it has ended, or stop it; what it has graded so far is kept."
        )


class MasterUnusable(GradingError):
    """A source notebook of the class cannot be graded against."""


class DiskFull(GradingError):
    """There is no room left on the disk."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"The disk that holds {path} is full. Free some room and run the same command again: "
            "what was graded so far is kept, and no grade of an earlier run is shown in its place."
        )


def is_disk_full(error: BaseException | None) -> bool:
    """Whether a full disk (or an exhausted quota) is at the bottom of ``error``."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            return True
        if "disk is full" in str(error) and type(error).__module__.startswith(("sqlite3", "sqlalchemy")):
            return True
        error = error.__cause__ or error.__context__
    return False


@contextlib.contextmanager
def clear_disk_errors(path: Path) -> Iterator[None]:
    """Say in an instructor's words what the disk says.

    Args:
        path: The class that is worked on.

    Raises:
        DiskFull: There is no room left, whoever noticed it.
        GradingError: Something may not be read or written.
    """
    try:
        yield
    except GradingError:
        raise
    except Exception as error:
        if is_disk_full(error):
            raise DiskFull(path) from error
        if isinstance(error, PermissionError):
            raise GradingError(
                f"{error.filename or path} may not be read or written by you. Look at its owner and its mode."
            ) from error
        raise
