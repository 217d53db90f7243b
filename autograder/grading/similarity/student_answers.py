"""Reads from the notebooks of a class the code that students wrote, and the code that students received."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.execution.executed_cells import CellType
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.grading_errors import MasterUnusable
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id, is_answer
from autograder.grading.rebuilding.submission_desk import read_notebook
from autograder.grading.rebuilding.submitted_notebook import NotAFile, UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory, Submission


OWN_CELLS = "own cells"
"""The name of an answer that consists of all cells that a student added to a notebook."""


@dataclass(frozen=True)
class StudentAnswer:
    """A student's text in one solution cell, or in all cells that the student added.

    Attributes:
        cell: The name of the cell; ``OWN_CELLS`` for the added cells.
        text: The text of the cell, or of all added cells.
    """

    student: str
    assignment: str
    notebook: str
    cell: str
    text: str


@dataclass
class HandedIn:
    """The submitted answers to one notebook.

    Attributes:
        answers: The answers of each student, in the order of the cells.
        students: The students whose notebooks could be read.
        troubles: A line for each submission that could not be read, or only in part.
    """

    answers: list[StudentAnswer] = field(default_factory=list)
    students: list[str] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)


def given_texts(directory: ClassDirectory) -> list[str]:
    """Return the texts of all code cells in ``source`` and ``release``: code that students received, and solutions.

    Raises:
        MasterUnusable: A file in these folders is not a notebook.
    """
    return [
        cell.source
        for folder in ("source", "release")
        for path in sorted((directory.path / folder).glob(f"*/*{SUFFIX}"))
        for cell in _cells(directory, path.relative_to(directory.path).as_posix())
        if cell.cell_type == CellType.CODE
    ]


def read_answers(
    directory: ClassDirectory, assignment: str, notebook: str, submissions: list[Submission]
) -> HandedIn:
    """Return the submitted answers to one notebook.

    Raises:
        MasterUnusable: The source is not a valid notebook.
    """
    named = {
        name: cell
        for cell in _cells(directory, f"source/{assignment}/{notebook}{SUFFIX}")
        if (name := grade_id(cell))
    }
    answers = [name for name, cell in named.items() if is_answer(cell) and cell.cell_type == CellType.CODE]
    handed_in = HandedIn()
    for submission in submissions:
        who = f"{submission.student}/{assignment}"
        try:
            data = read_bytes(submission.folder / f"{notebook}{SUFFIX}")
            cells, left_out = read_notebook(data, directory.state)
        except NotAFile:
            continue  # the instructor gets a line about this refused file elsewhere
        except UnreadableSubmission as error:
            handed_in.troubles.append(f"unreadable   {who}: {error}")
            continue
        if left_out:
            handed_in.troubles.append(
                f"left out     {who}: {left_out} cell(s) were not valid notebook cells, or were too long; "
                "the other cells were compared"
            )
        handed_in.students.append(submission.student)
        written: dict[str, list[str]] = {}
        for cell in cells:
            # If a student changed the type of an answer cell, the answer is compared all the same, as in grading.
            if cell.grade_id in answers or (cell.kind == CellType.CODE and cell.grade_id not in named):
                name = cell.grade_id if cell.grade_id in answers else OWN_CELLS
                written.setdefault(name, []).append(cell.source)
        for name in (*answers, OWN_CELLS):
            if name in written:
                text = "\n\n".join(written[name])
                handed_in.answers.append(StudentAnswer(submission.student, assignment, notebook, name, text))
    return handed_in


def _cells(directory: ClassDirectory, file: str) -> list[NotebookNode]:
    path = directory.path / file
    try:
        return list(nbformat_nodes.read(path.read_text(encoding="utf-8")).cells)
    except Exception as error:  # nbformat may raise any error of its JSON and schema libraries
        raise MasterUnusable(
            f"{path} is not a notebook: {error}. Make the notebook again, or restore a copy."
        ) from error
