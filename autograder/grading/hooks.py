"""What nbgrader calls before it converts a submission."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.entering import gradebook

if TYPE_CHECKING:
    from collections.abc import Sequence


def before_autograde(notebooks: Sequence[str], **_: Any) -> None:
    """Take back the grades of the submission that is about to be graded.

    nbgrader may still fail before it reads the first notebook (a file that cannot be copied, say), and would
    then leave yesterday's score in the gradebook.

    Args:
        notebooks: Full paths ``.../submitted/<student>/<assignment>/<notebook>.ipynb`` of one submission.
    """
    if not notebooks:
        return
    folder = Path(notebooks[0]).parent
    directory = ClassDirectory(folder.parents[2])
    gradebook.reset(directory.gradebook_url, [(folder.name, folder.parent.name)])
