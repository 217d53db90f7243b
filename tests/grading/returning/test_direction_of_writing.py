"""No character turns a line around: neither in a page nor in a table nor in a terminal."""

from __future__ import annotations

from typing import Any

import nbformat
import pytest

from autograder.cards.readable_text import one_line
from autograder.grading.returning.sanitize import escape_direction_marks, make_harmless
from autograder.grading.table.spreadsheet_csv import defused
from autograder.standard_output import printable

TURNS = [chr(code) for code in (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))]


@pytest.mark.parametrize("turn", TURNS, ids=ascii)
def test_it_is_shown_or_left_out_wherever_a_students_text_goes(turn: str) -> None:
    text = f"10 of 10{turn}0 of 10"
    new: Any = nbformat.v4
    cells = [
        new.new_markdown_cell(text),
        new.new_markdown_cell(f"10 &#{ord(turn)}; 0 &#x{ord(turn):x};"),
        new.new_raw_cell(text),
        new.new_code_cell(
            text,
            outputs=[
                new.new_output("stream", text=text),
                new.new_output("stream", text=[text]),
                new.new_output("display_data", data={"text/plain": text}),
                new.new_output("error", ename=text, evalue=text, traceback=[text]),
            ],
        ),
    ]
    notebook = make_harmless(new.new_notebook(cells=cells), range(4))
    assert turn not in nbformat.v4.writes_json(notebook, ensure_ascii=False)
    assert f"&amp;#{ord(turn)};" in notebook.cells[1].source
    for shown in (escape_direction_marks(text), printable(text), one_line(text, 100), defused(text)):
        assert turn not in shown


def test_scripts_that_are_written_from_right_to_left_stay() -> None:
    hebrew = "\u05e9\u05dc\u05d5\u05dd 5"
    assert escape_direction_marks(hebrew) == hebrew
