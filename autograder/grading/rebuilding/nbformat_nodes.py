"""Makes, reads and writes notebooks with nbformat, and adds the type annotations that nbformat lacks."""

from __future__ import annotations

import uuid
from typing import Any

import msgspec
import nbformat
from nbformat import NotebookNode
from nbformat.v4 import rwbase

from autograder.execution.executed_cells import CellType

_nbformat: Any = nbformat


def notebook(cells: list[NotebookNode], metadata: dict[str, Any]) -> NotebookNode:
    """Return a notebook of format 4.5 with these cells, which are not validated because this package made them."""
    return NotebookNode(metadata=_node(metadata), nbformat=4, nbformat_minor=5, cells=cells)


def cell(kind: CellType, source: str, identifier: str = "") -> NotebookNode:
    """Return a new cell without outputs, and without nbformat's slow validation.

    Args:
        kind: The type of the cell.
        source: The text of the cell.
        identifier: The id of the cell; a random id if empty.
    """
    node = NotebookNode(
        id=identifier or uuid.uuid4().hex[:8], cell_type=str(kind), metadata=NotebookNode(), source=source
    )
    if kind is CellType.CODE:
        node["execution_count"] = None
        node["outputs"] = []
    return node


def output(**fields: Any) -> NotebookNode:
    """Return an output of a cell with the given fields.

    The fields are not validated, because all outputs of students' cells were built by
    :class:`autograder.execution.executed_cells.OutputCollector`.
    """
    node: NotebookNode = _node(fields)
    return node


def read(text: str) -> NotebookNode:
    """Return the notebook in a JSON text.

    Raises:
        Exception: Any error of nbformat's JSON and schema libraries.
    """
    read_notebook: NotebookNode = _nbformat.reads(text, as_version=4)
    return read_notebook


def read_own(data: bytes) -> NotebookNode:
    """Return a notebook of format 4 that this package wrote, and which is therefore not validated.

    Raises:
        msgspec.DecodeError: The data is not JSON.
    """
    rejoin: Any = rwbase.rejoin_lines
    joined: NotebookNode = rejoin(_node(msgspec.json.decode(data)))
    return joined


def text(of: NotebookNode) -> str:
    """Return the JSON text of a notebook."""
    written: str = _nbformat.writes(of)
    return written


def copied(of: NotebookNode) -> NotebookNode:
    """Return a deep copy of a notebook or cell."""
    copy: NotebookNode = _node(of)
    return copy


def _node(value: Any) -> Any:
    """Copy a JSON value, and turn each dictionary into a ``NotebookNode``."""
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return NotebookNode({key: _node(item) for key, item in value.items()})
    if isinstance(value, list | tuple):
        return [_node(item) for item in value]
    return value
