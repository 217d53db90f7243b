"""The notebooks to execute, and their expected results: full marks for a master, no points for a student's notebook."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from autograder.boxes.limits import Limits
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.task_making import cells_of
from autograder.grading.task import Task
from autograder.masters.layout import chapter_path, lab_name, masters
from autograder.masters.source import source_notebook
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nbformat import NotebookNode

LIMITS = Limits(cell_seconds=180.0, notebook_seconds=900.0)
"""Time limits of a cell and a notebook, longer than for a submission: a cell may build a workspace, and several
notebooks share the machine.
"""


class NotebookKind(StrEnum):
    """The kind of a notebook, which decides its expected result."""

    MASTER = "master"
    """The master, which contains the solutions, has to earn full marks."""
    CHAPTER = "chapter"
    """The notebook as students get it has to earn no points and raise no error."""


@dataclass(frozen=True)
class Planned:
    """A notebook that will be executed.

    Attributes:
        kind: Whether the notebook is a master, or as students get it.
        notebook: The notebook in format 4.5, without outputs.
        task: The same notebook as a task for execution.
    """

    kind: NotebookKind
    notebook: NotebookNode
    task: Task

    @property
    def label(self) -> str:
        """The name of the notebook in messages, such as ``"master lab_1_2"``."""
        return f"{self.kind} {self.task.notebook}"


class NothingToExecuteError(LookupError):
    """A notebook does not exist, was not built, or is damaged. The message says what to do."""


def plan(root: Path, only: Sequence[str] = ()) -> list[Planned]:
    """Return two notebooks for each lab of a course: the master, and the one that students get.

    The second notebook is the file in ``chapters`` that students open. It is not built again.

    Args:
        root: The top folder of the course, which contains ``solutions`` and ``chapters``.
        only: Names such as ``"lab_1_2"``; all notebooks if empty.

    Raises:
        NothingToExecuteError: A name does not exist; or a file in ``chapters`` is missing or not a notebook.
        autograder.masters.master_errors.MasterError: A master cannot be used.
    """
    found = masters(root)
    known = [lab_name(master) for master in found]
    for name in only:
        if name not in known:
            raise NothingToExecuteError(
                f"no notebook is named {name!r}. The notebooks are: {', '.join(known)}."
            )
    planned = []
    for master in found:
        if only and lab_name(master) not in only:
            continue
        chapter = chapter_path(root, master)
        if not chapter.is_file():
            raise NothingToExecuteError(f"{chapter.relative_to(root)} does not exist: run `{COMMAND} build`.")
        try:
            built = nbformat_nodes.read(chapter.read_text(encoding="utf-8"))
        except Exception as error:  # nbformat may raise any error of the libraries that it uses
            raise NothingToExecuteError(
                f"{chapter.relative_to(root)} is not a notebook: run `{COMMAND} build`."
            ) from error
        planned.append(_planned(NotebookKind.MASTER, lab_name(master), source_notebook(master)))
        planned.append(_planned(NotebookKind.CHAPTER, lab_name(master), built))
    return planned


def _planned(kind: NotebookKind, name: str, notebook: NotebookNode) -> Planned:
    task = Task(
        student=kind,
        assignment="execute",
        notebook=name,
        cells=cells_of(notebook),
        seed=f"execute {name}",
        course="",
        limits=LIMITS,
        # No sandbox is needed, because these are the course's own notebooks.
        boxed=False,
    )
    return Planned(kind, notebook, task)
