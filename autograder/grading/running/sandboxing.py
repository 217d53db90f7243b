"""Requires a sandbox: without one, nothing is graded unless the user explicitly asked for that."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory

NOTE = (
    "Graded without a sandbox: the submissions ran with all rights of the person who graded them, "
    "and could have changed any grade."
)
"""A warning that the report and every feedback page show if a class was graded without a sandbox."""


class SandboxMissing(GradingError):
    """Submissions cannot be boxed on this machine, and the user has not asked to grade without boxes."""


_off: set[Path] = set()
"""The folders of the classes that this process grades without boxes. Folders are stored, and not ``ClassDirectory``
objects, because several such objects may represent one class.
"""


def switch_off(path: Path) -> None:
    """Let this process grade the class in the folder ``path`` without boxes, as ``--unsafe-no-sandbox`` does."""
    _off.add(path.resolve())


def switched_off(directory: ClassDirectory) -> bool:
    """Return True if this class is graded without boxes, because of its configuration or :func:`switch_off`."""
    configured = directory.config.WireExecute.get("unsafe_no_sandbox", False)
    return bool(configured) or directory.path.resolve() in _off


def require(directory: ClassDirectory) -> None:
    """Check that submissions of this class can be boxed, or that the user allowed grading without boxes.

    Raises:
        SandboxMissing: Submissions cannot be boxed, and the user did not allow grading without boxes. The message says
            what to do.
    """
    if switched_off(directory):
        return
    from autograder.boxes.sandbox import why_impossible

    why = why_impossible()
    if why:
        raise SandboxMissing(
            f"Submissions cannot be isolated from your files and from each other here: {why}. To grade "
            "them nevertheless, trusting every submission: --unsafe-no-sandbox, or "
            "c.WireExecute.unsafe_no_sandbox = True in nbgrader_config.py."
        )
