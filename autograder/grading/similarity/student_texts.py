"""Reads students' own texts from the notebooks of a class, and the texts that students received."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.execution.cells import CellType
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.errors import MasterUnusable
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.rebuild import grade_id, is_answer
from autograder.grading.rebuilding.submission import NotAFile, UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory, Submission

OWN_CELLS = "own cells"
"""The name that is used for all cells that a student added, taken together."""


@dataclass(frozen=True)
class StudentAnswer:
    """A student's text in one solution cell, or in all cells that the student added.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        notebook: The notebook's name.
        cell: The name of the cell.
        text: The text of the cell.
    """

    student: str
    assignment: str
    notebook: str
    cell: str
    text: str


@dataclass
class HandedIn:
    """The answers that were handed in for one notebook.

    Attributes:
        answers: The answers, sorted by student and then by cell.
        students: The students whose notebooks could be read.
        troubles: A line for each submission that could not be read, or only partly.
    """

    answers: list[StudentAnswer] = field(default_factory=list)
    students: list[str] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)


def given_texts(directory: ClassDirectory) -> list[str]:
    """Return all code in the class's sources and hand-outs: what students received, and every solution.

    Raises:
        MasterUnusable: A source is not a notebook.
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
    """Return the answers that were handed in for one notebook.

    Raises:
        MasterUnusable: The source is not a notebook.
    """
    named = {
        name: cell
        for cell in _cells(directory, f"source/{assignment}/{notebook}{SUFFIX}")
        if (name := grade_id(cell))
    }
    answers = [name for name, cell in named.items() if is_answer(cell) and cell.cell_type == CellType.CODE]
    found = HandedIn()
    for submission in submissions:
        who = f"{submission.student}/{assignment}"
        try:
            cells, left_out = read_notebook(read_bytes(submission.folder / f"{notebook}{SUFFIX}"))
        except NotAFile:
            continue  # the class lists this file as refused
        except UnreadableSubmission as error:
            found.troubles.append(f"unreadable   {who}: {error}")
            continue
        if left_out:
            found.troubles.append(
                f"left out     {who}: {left_out} cell(s) had not the form of a cell, or were too long; "
                "the others are compared"
            )
        found.students.append(submission.student)
        written: dict[str, list[str]] = {}
        for cell in cells:
            # An answer counts whatever type its cell has now, as it does in grading.
            if cell.grade_id in answers or (cell.kind == CellType.CODE and cell.grade_id not in named):
                name = cell.grade_id if cell.grade_id in answers else OWN_CELLS
                written.setdefault(name, []).append(cell.source)
        for name in (*answers, OWN_CELLS):
            if name in written:
                text = "\n\n".join(written[name])
                found.answers.append(StudentAnswer(submission.student, assignment, notebook, name, text))
    return found


def _cells(directory: ClassDirectory, place: str) -> list[NotebookNode]:
    path = directory.path / place
    try:
        return list(nbformat_nodes.read(path.read_text(encoding="utf-8")).cells)
    except Exception as error:  # nbformat passes on all errors of its JSON and schema libraries
        raise MasterUnusable(
            f"{path} is not a notebook: {error}. Make it again or put back a copy."
        ) from error
