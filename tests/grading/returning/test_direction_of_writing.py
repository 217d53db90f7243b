"""No character turns a line around or controls a program: neither in a page nor in a table nor in a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat
import pytest

from autograder.cards.readable_text import one_line
from autograder.grading.returning.page_exporter import PageExporter
from autograder.grading.returning.sanitize import escape_marks, make_harmless
from autograder.grading.table.spreadsheet_csv import defused
from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

TURNS = [chr(code) for code in (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))]

CONTROLS = [chr(code) for code in (*range(32), *range(127, 160)) if chr(code) not in "\t\n\r"]


def texts_in(value: Any) -> Iterator[str]:
    """Yield each text of a notebook."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for part in value.values() if isinstance(value, dict) else value:
            yield from texts_in(part)


@pytest.mark.parametrize("turn", [*TURNS, *CONTROLS], ids=ascii)
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
    assert turn not in "".join(texts_in(notebook))
    assert f"&amp;#{ord(turn)};" in notebook.cells[1].source
    for shown in (escape_marks(text), printable(text), one_line(text, 100), defused(text)):
        assert turn not in shown


def test_of_codes_for_a_terminal_a_page_has_the_colors_alone() -> None:
    link = "\x1b]8;;https://example.com\x1b\\here\x1b]8;;\x07"
    text = f"\x1b[1;31mred\x1b[0m \x1b[2K{link} \x1b[\n \x1b"
    cell = nbformat.v4.new_code_cell("", outputs=[nbformat.v4.new_output("stream", text=text)])
    notebook = make_harmless(nbformat.v4.new_notebook(cells=[cell]))
    page = PageExporter().page(
        notebook, {"notebook": "lab", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
    )
    assert "red</span>" in page
    assert "\\x1b]8;;https://example.com\\x1b\\here\\x1b]8;;\\x07" in page
    assert not set(page) & set(CONTROLS)


def test_scripts_that_are_written_from_right_to_left_stay() -> None:
    hebrew = "\u05e9\u05dc\u05d5\u05dd 5"
    assert escape_marks(hebrew) == hebrew
