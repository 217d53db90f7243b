"""Notebooks that students might hand in: sample notebooks with odd cells, and answers from the bank of notebooks."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.execution.executed_cells import CellType
from autograder.grading.new_classes.sample_class import SampleNotebook, sample_text
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id

if TYPE_CHECKING:
    from nbformat import NotebookNode

FIXTURES = Path(__file__).with_name("fixture_class.toml")
BANK = Path("tests", "submissions", "notebooks")
"""The path, in the course, of a folder with right and wrong sample answers."""


@dataclass(frozen=True)
class OddNotebook(SampleNotebook):
    """The description of one student's notebook, with the fields that the data file explains."""

    bank: tuple[str, ...] = ()
    answers: dict[str, str] = field(default_factory=dict)
    delete: tuple[str, ...] = ()
    duplicate: tuple[str, ...] = ()
    retype: dict[str, CellType] = field(default_factory=dict)
    insert: dict[str, str] = field(default_factory=dict)
    file: str = ""


class _Data(msgspec.Struct):
    notebook: tuple[OddNotebook, ...]


def odd_notebooks() -> tuple[OddNotebook, ...]:
    """Return the descriptions of all notebooks of the data file."""
    return msgspec.toml.decode(FIXTURES.read_bytes(), type=_Data).notebook


@dataclass(frozen=True)
class _Answer:
    """A student's text for a solution cell, and the texts of the cells that the student added before it."""

    source: str
    extra: tuple[str, ...] = ()


def text_of(path: Path, wanted: SampleNotebook) -> str:
    """Return the text of a student's file.

    Args:
        path: The class, with notebooks in ``source`` and ``release``.
        wanted: The description of the notebook.
    """
    text = sample_text(path, wanted)
    if not isinstance(wanted, OddNotebook) or wanted.file:
        return getattr(wanted, "file", text)
    notebook = nbformat_nodes.read(text)
    answers = {name: answer for file in wanted.bank for name, answer in _bank_answers(file).items()}
    answers |= {name: _Answer(text.strip()) for name, text in wanted.answers.items()}
    notebook.cells = [changed for cell in notebook.cells for changed in _changed(cell, wanted, answers)]
    return nbformat_nodes.text(notebook)


def _changed(cell: NotebookNode, wanted: OddNotebook, answers: dict[str, _Answer]) -> list[NotebookNode]:
    """Return the cells that replace one cell in the student's notebook."""
    name = grade_id(cell)
    if not name:
        return [cell]
    answer = _Answer(cell.source) if name in wanted.change else answers.get(name, _Answer(cell.source))
    cell.source = answer.source
    before = [nbformat_nodes.cell(CellType.CODE, source) for source in answer.extra]
    if name in wanted.insert:
        before.append(nbformat_nodes.cell(CellType.CODE, wanted.insert[name]))
    if name in wanted.delete:
        return before
    if name in wanted.retype:
        retyped = nbformat_nodes.cell(wanted.retype[name], cell.source)
        retyped.metadata = cell.metadata
        return [*before, retyped]
    if name in wanted.duplicate:
        twin = nbformat_nodes.copied(cell)
        twin.id = f"{cell.id}-again"[:64]
        return [*before, cell, twin]
    return [*before, cell]


def _bank_answers(file: str) -> dict[str, _Answer]:
    """Read a sample answer from a file in which each cell begins with ``# %% extra`` or ``# %% solution NAME``."""
    text = (course.root() / BANK / file).read_text(encoding="utf-8")
    answers: dict[str, _Answer] = {}
    extra: list[str] = []
    for part in text.split("# %% ")[1:]:
        head, _, source = part.partition("\n")
        kind, _, name = head.strip().partition(" ")
        if kind == "solution":
            answers[name] = _Answer(source.strip(), tuple(extra))
            extra = []
        else:
            extra.append(source.strip())
    return answers
