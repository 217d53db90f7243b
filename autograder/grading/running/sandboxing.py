"""Requires a sandbox: without one, grading stops unless the user explicitly asked for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory

NOTE = (
    "Graded without a sandbox: what was handed in ran with all rights of whoever graded it "
    "and could have changed any grade."
)
"""Shown in the report and on each page of feedback."""


class SandboxMissing(GradingError):
    """Submissions cannot be boxed on this machine, and the user has not asked to grade without boxes."""


_off: set[Path] = set()
"""Folders of the classes for which ``--unsafe-no-sandbox`` was given; several objects may stand for one class."""


def switch_off(path: Path) -> None:
    """Grade the class at ``path`` without boxes from now on, in this process: the option ``--unsafe-no-sandbox``."""
    _off.add(path.resolve())


def switched_off(directory: ClassDirectory) -> bool:
    """True if this class is graded without boxes, because of its configuration or :func:`switch_off`."""
    configured = directory.config.WireExecute.get("unsafe_no_sandbox", False)
    return bool(configured) or directory.path.resolve() in _off


def require(directory: ClassDirectory) -> None:
    """Check that submissions of this class can be boxed, or that the user allowed grading without boxes.

    Raises:
        SandboxMissing: The message gives the reason, and says what to do.
    """
    if switched_off(directory):
        return
    from autograder.boxes.sandbox import why_impossible

    why = why_impossible()
    if why:
        raise SandboxMissing(
            f"Submissions cannot be shut off from your files and from each other here: {why}. "
            "To grade all the same, trusting every submission: --unsafe-no-sandbox, "
            "or c.WireExecute.unsafe_no_sandbox = True in nbgrader_config.py."
        )
