"""nbformat's constructors with types: the library itself has none."""

from __future__ import annotations

import uuid
from typing import Any

import msgspec
import nbformat
from nbformat import NotebookNode
from nbformat.v4 import rwbase

from autograder.boxes.execution import CellType

_nbformat: Any = nbformat


class _Stream(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="output_type", tag="stream"):
    name: str
    text: str


class _Display(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="output_type", tag="display_data"
):
    data: dict[str, str]
    metadata: dict[str, Any]


class _Result(_Display, frozen=True, forbid_unknown_fields=True, tag="execute_result"):
    execution_count: int | None


class _Error(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="output_type", tag="error"):
    ename: str
    evalue: str
    traceback: list[str]


_OUTPUT: Any = _Stream | _Display | _Result | _Error


def notebook(cells: list[NotebookNode], metadata: dict[str, Any]) -> NotebookNode:
    """A notebook of format 4.5, not validated: its cells come from the master, or from :func:`cell`."""
    return NotebookNode(metadata=_node(metadata), nbformat=4, nbformat_minor=5, cells=cells)


def cell(kind: CellType, source: str, identifier: str = "") -> NotebookNode:
    """A cell without outputs, and without nbformat's validation: it would take longer than all the rest.

    Args:
        kind: Its type.
        source: Its text.
        identifier: Its id; drawn at random by default.
    """
    made = NotebookNode(
        id=identifier or uuid.uuid4().hex[:8], cell_type=str(kind), metadata=NotebookNode(), source=source
    )
    if kind is CellType.CODE:
        made["execution_count"] = None
        made["outputs"] = []
    return made


def output(**fields: Any) -> NotebookNode:
    """An output from its fields as nbformat names them, of the kinds that boxes hand over.

    This check replaces nbformat's, which takes a hundred times as long.

    Raises:
        msgspec.ValidationError: They are not those of an output.
    """
    msgspec.convert(fields, _OUTPUT)
    made: NotebookNode = _node(fields)
    return made


def read(text: str) -> NotebookNode:
    """A notebook from its text.

    Raises:
        Exception: Whatever nbformat's JSON and schema libraries raise.
    """
    read_notebook: NotebookNode = _nbformat.reads(text, as_version=4)
    return read_notebook


def read_own(data: bytes) -> NotebookNode:
    """A notebook of format 4 from its text, without nbformat's validation: we have written it ourselves.

    Raises:
        msgspec.DecodeError: It is not JSON.
    """
    rejoin: Any = rwbase.rejoin_lines
    joined: NotebookNode = rejoin(_node(msgspec.json.decode(data)))
    return joined


def text(of: NotebookNode) -> str:
    """The text of a notebook."""
    written: str = _nbformat.writes(of)
    return written


def copied(of: NotebookNode) -> NotebookNode:
    """A copy that shares nothing with the original that can be changed."""
    made: NotebookNode = _node(of)
    return made


def _node(value: Any) -> Any:
    """Copy JSON values, with each dictionary as a node."""
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return NotebookNode({key: _node(item) for key, item in value.items()})
    if isinstance(value, list | tuple):
        return [_node(item) for item in value]
    return value
