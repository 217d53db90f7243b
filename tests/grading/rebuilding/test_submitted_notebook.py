from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding.notebook_parsing import parse
from autograder.grading.rebuilding.submitted_notebook import SubmittedCell, UnreadableSubmission, read_bytes
from tests.hard_links import hard_link

if TYPE_CHECKING:
    from pathlib import Path


def notebook(*cells: Any, **fields: Any) -> bytes:
    return json.dumps(
        {"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": list(cells), **fields}
    ).encode()


def code(source: Any, **fields: Any) -> dict[str, Any]:
    return {"cell_type": "code", "source": source, "metadata": {}, "outputs": [], **fields}


def test_takes_the_text_the_claimed_name_and_the_id_and_nothing_else() -> None:
    tagged = code(
        ["a = 1\n", "b = 2"],
        metadata={"tags": ["skip-execution"], "nbgrader": {"grade_id": "Talker", "points": 1000}},
        attachments={"x": {}},
        id="x",
    )
    cells, left_out = parse(notebook(tagged))
    assert cells == [SubmittedCell(CellType.CODE, "a = 1\nb = 2", "Talker", "x")]
    assert left_out == 0


def test_leaves_out_what_is_no_cell() -> None:
    cells, left_out = parse(
        notebook(
            code("1"),
            3,
            None,
            {"cell_type": "shell", "source": ""},
            {"cell_type": ["code"]},
            code({"a": 1}),
            code([1]),
        )
    )
    assert [cell.source for cell in cells] == ["1"]
    assert left_out == 6


def test_metadata_of_any_form_is_no_name() -> None:
    strange: list[Any] = [[], "x", {"nbgrader": 1}, {"nbgrader": {"grade_id": ["x"]}}, None]
    for metadata in strange:
        assert parse(notebook(code("1", metadata=metadata)))[0][0].grade_id == ""


def test_reads_a_notebook_of_format_3() -> None:
    old = {"nbformat": 3, "worksheets": [{"cells": [{"cell_type": "code", "input": ["x = 1"]}]}]}
    assert parse(json.dumps(old).encode())[0] == [SubmittedCell(CellType.CODE, "x = 1")]


def test_a_byte_order_mark_is_no_obstacle() -> None:
    assert parse(b"\xef\xbb\xbf" + notebook(code("1")))[0][0].source == "1"


def test_names_what_was_found_in_place_of_the_notebook(tmp_path: Path) -> None:
    (tmp_path / "lab_1_2 (1).ipynb").write_bytes(notebook())
    with pytest.raises(
        UnreadableSubmission, match=r"no notebook named lab_1_2.ipynb\. .* lab_1_2 \(1\).ipynb"
    ):
        read_bytes(tmp_path / "lab_1_2.ipynb")


MINE = "submitted/eve/lab/lab.ipynb"


@pytest.mark.parametrize(
    ("other", "refused"),
    [
        ("submitted/ada/lab/lab.ipynb", True),
        ("source/lab/lab.ipynb", True),
        ("../backup/lab.ipynb", False),
    ],
    ids=["a neighbour's work", "the master", "a backup"],
)
def test_only_a_second_name_of_the_class_is_refused(tmp_path: Path, other: str, refused: bool) -> None:
    first, mine = tmp_path / "class" / other, tmp_path / "class" / MINE
    for name in (first, mine):
        name.parent.mkdir(parents=True, exist_ok=True)
    first.write_text("{}")
    hard_link(mine, first)
    if refused:
        with pytest.raises(UnreadableSubmission, match="hard link"):
            read_bytes(mine)
    else:
        assert read_bytes(mine) == b"{}"
    if other.startswith("submitted"):
        assert read_bytes(first) == b"{}", "who was there first keeps it"


def test_of_what_is_attached_only_bitmaps_are_taken() -> None:
    attached = {
        "shot.png": {"image/png": ["aGVs\n", "bG8="], "text/html": "<b>"},
        "photo.jpg": {"image/jpeg": "aGVsbG8="},
        "drawn.svg": {"image/svg+xml": "PHN2Zz4="},
        "odd.png": {"image/png": "<script>"},
        "none.png": "aGVsbG8=",
        "list.png": {"image/png": [1]},
    }
    text = {"cell_type": "markdown", "source": "x", "attachments": attached}
    assert parse(notebook(text))[0][0].pictures == (
        ("shot.png", "image/png", "aGVs\nbG8="),
        ("photo.jpg", "image/jpeg", "aGVsbG8="),
    )
    odd = {"cell_type": "markdown", "source": "x", "attachments": ["x"]}
    assert parse(notebook(odd))[0][0].pictures == ()
