"""Parses a notebook into typed cells with limited sizes, and drops everything else, such as outputs.

The class's source notebooks may be parsed in any process. But a student's file is parsed only in a desk, so call
:func:`autograder.grading.rebuilding.submission_desk.read_notebook` for it. The desk is a process in a box that parses
the file of one student with :func:`read`, and does nothing else. If a student has crafted a file that keeps a parser
busy or uses up memory, the limits of this process end it.
"""

from __future__ import annotations

import gc
import json
import os
from collections.abc import Iterator, Mapping
from typing import IO, Any

import msgspec

from autograder.execution.executed_cells import IMAGES, CellType
from autograder.grading.rebuilding.submitted_notebook import (
    BASE64,
    LONGEST_NAME,
    LONGEST_REASON,
    MAX_CELL_CHARACTERS,
    MAX_CELLS,
    MAX_CHARACTERS,
    Picture,
    ReadNotebook,
    SubmittedCell,
    Unreadable,
    UnreadableSubmission,
)

_CELL_TYPES = tuple(CellType)


def parse(data: bytes) -> tuple[list[SubmittedCell], int]:
    """Return the cells of a submitted notebook.

    Returns:
        The cells, and the number of cells that were left out because they are not valid cells.

    Raises:
        UnreadableSubmission: The file is not a notebook.
    """
    notebook = _decoded(data)
    if not isinstance(notebook, Mapping) or not isinstance(notebook.get("nbformat"), int):
        raise UnreadableSubmission("The file is JSON, but not a Jupyter notebook.")
    cells = _raw_cells(notebook)
    if len(cells) > MAX_CELLS:
        raise UnreadableSubmission(f"The notebook has {len(cells)} cells; the limit is {MAX_CELLS}.")
    taken = [cell for cell in map(_cell, cells) if cell is not None]
    characters = sum(len(cell.source) for cell in taken)
    if characters > MAX_CHARACTERS:
        raise UnreadableSubmission(
            f"The cells of the notebook have {characters} characters; the limit is {MAX_CHARACTERS}."
        )
    return taken, len(cells) - len(taken)


def _decoded(data: bytes) -> Any:
    if not data.strip(b"\0 \t\r\n"):
        raise UnreadableSubmission(
            f"The file is empty: {len(data)} bytes, and no text. Save the notebook in JupyterLab and hand in that file."
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not UTF-8 text (byte {error.start}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None
    try:
        return json.loads(text)
    except RecursionError:
        raise UnreadableSubmission("The file is not a notebook: its JSON is nested too deeply.") from None
    except ValueError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not JSON ({error}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None


def _raw_cells(notebook: Mapping[str, Any]) -> list[Any]:
    if notebook["nbformat"] == 3 and isinstance(notebook.get("worksheets"), list):
        sheets = [sheet.get("cells") for sheet in notebook["worksheets"] if isinstance(sheet, Mapping)]
        return [
            {**cell, "source": cell.get("input", cell.get("source"))} if isinstance(cell, Mapping) else cell
            for cells in sheets
            if isinstance(cells, list)
            for cell in cells
        ]
    cells = notebook.get("cells")
    if notebook["nbformat"] != 4 or not isinstance(cells, list):
        raise UnreadableSubmission(
            f"This is not a notebook of format 4 (the file says format {str(notebook['nbformat'])[:20]})."
        )
    return cells


def _cell(cell: Any) -> SubmittedCell | None:
    if not isinstance(cell, Mapping) or cell.get("cell_type") not in _CELL_TYPES:
        return None
    source = cell.get("source")
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    if not isinstance(source, str) or len(source) > MAX_CELL_CHARACTERS:
        return None
    metadata = cell.get("metadata")
    marks = metadata.get("nbgrader") if isinstance(metadata, Mapping) else None
    marks = marks if isinstance(marks, Mapping) else {}
    return SubmittedCell(
        CellType(cell["cell_type"]),
        _text(source),
        _name(marks.get("grade_id")),
        _name(cell.get("id")),
        marks.get("grade") is True,
        tuple(_pictures(cell)),
    )


def _pictures(cell: Mapping[str, Any]) -> Iterator[Picture]:
    """Yield the bitmaps attached to a cell. SVG drawings are skipped, because they may contain scripts."""
    attached = cell.get("attachments")
    for name, kinds in attached.items() if isinstance(attached, Mapping) else ():
        for kind in IMAGES if isinstance(kinds, Mapping) else ():
            data = kinds.get(kind)
            data = "".join(data) if isinstance(data, list) and all(isinstance(x, str) for x in data) else data
            if isinstance(data, str) and BASE64.fullmatch(data):
                yield _name(name), kind, data
                break


def _name(value: Any) -> str:
    return _text(value)[:LONGEST_NAME] if isinstance(value, str) else ""


def _text(value: str) -> str:
    """Return a text without lone surrogates, which JSON allows, but which UTF-8 cannot encode."""
    return value.encode("utf-8", "replace").decode("utf-8")


_SAMPLE = (
    b'\xef\xbb\xbf{"nbformat": 4, "metadata": {}, "cells": [{"cell_type": "markdown", "source": ["\\ud800"], '
    b'"metadata": {"nbgrader": {"grade_id": "a", "grade": true}}, "attachments": {"a.png": {"image/png": "aa=="}}}]}'
)
"""A notebook that makes the parser load everything that it would otherwise load when it is first needed."""


def rehearse() -> None:
    """Load everything that :func:`read` needs, because a desk itself cannot open files."""
    for data in (_SAMPLE, b"[", b"\xff"):
        answer_to(data)


def read(file: IO[bytes]) -> Iterator[bytes]:
    """Yield the answer about the file of a student."""
    # No garbage collection: a desk process frees nothing before it ends, so searches for garbage only take time.
    gc.disable()
    yield answer_to(os.pread(file.fileno(), file.seek(0, os.SEEK_END), 0))


def answer_to(data: bytes) -> bytes:
    """Return the document about a file as JSON: the cells, or the reason why the file cannot be read."""
    document: ReadNotebook | Unreadable
    try:
        cells, left_out = parse(data)
        document = ReadNotebook(tuple(cells), left_out)
    except UnreadableSubmission as error:
        document = Unreadable(str(error)[:LONGEST_REASON])
    except MemoryError:
        document = Unreadable("Reading the file takes far more memory than reading a notebook.")
    return msgspec.json.encode(document)
