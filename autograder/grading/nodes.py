"""nbformat's constructors with types: the library itself has none."""

from __future__ import annotations

import copy
import uuid
from typing import Any

import nbformat
from nbformat import NotebookNode, v4

from autograder.boxes.execution import Kind

_nbformat: Any = nbformat
_v4: Any = v4


def from_dict(fields: dict[str, Any]) -> NotebookNode:
    """A dictionary, and all that are in it, as nodes."""
    made: NotebookNode = _nbformat.from_dict(fields)
    return made


def notebook(cells: list[NotebookNode], metadata: dict[str, Any]) -> NotebookNode:
    """A notebook of format 4.5, not validated: its cells come from the master, or from :func:`cell`."""
    return NotebookNode(metadata=from_dict(metadata), nbformat=4, nbformat_minor=5, cells=cells)


def cell(kind: Kind, source: str) -> NotebookNode:
    """A cell without outputs, and without nbformat's validation: it would take longer than all the rest."""
    made = NotebookNode(id=uuid.uuid4().hex[:8], cell_type=str(kind), metadata=NotebookNode(), source=source)
    if kind is Kind.CODE:
        made.update(execution_count=None, outputs=[])
    return made


def output(**fields: Any) -> NotebookNode:
    """An output from its fields as nbformat names them."""
    made: NotebookNode = _v4.new_output(**fields)
    return made


def read(text: str) -> NotebookNode:
    """A notebook from its text.

    Raises:
        Exception: Whatever nbformat's JSON and schema libraries raise.
    """
    read_notebook: NotebookNode = _nbformat.reads(text, as_version=4)
    return read_notebook


def text(of: NotebookNode) -> str:
    """The text of a notebook."""
    written: str = _nbformat.writes(of)
    return written


def copied(of: NotebookNode) -> NotebookNode:
    """A copy that shares nothing with the original."""
    return copy.deepcopy(of)
