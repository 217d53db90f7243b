"""The master's figures are on the pages of a submission, as often as in the master and no more."""

from __future__ import annotations

import base64
from pathlib import Path

import nbformat
import pytest
from nbconvert.exporters import HTMLExporter
from nbformat import NotebookNode

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding.notebook_rebuilding import rebuild, rebuild_unreadable
from autograder.grading.rebuilding.submitted_notebook import SubmittedCell
from autograder.grading.returning.page_exporter import markdown_to_html
from autograder.grading.returning.sanitize import make_harmless

CHAPTERS = Path(__file__).resolve().parents[3] / "chapters"
PICTURE = 'src="data:image/png;base64,'
SHOWS = "![a graph](attachment:graph.png)"
DATA = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg=="
"""A PNG of one point."""
SHOT = base64.b64encode(base64.b64decode(DATA) + b"a screenshot of a student's").decode()
"""Another one; a browser does not mind what is behind its end."""


GIVEN = ("Look:\n\n" + SHOWS,)
"""The master's own texts."""


def page_of(notebook: NotebookNode) -> str:
    """The page that formgrader makes; nbgrader's feedback has the same filter, and marks around it."""
    exporter = HTMLExporter(filters={"markdown2html": markdown_to_html})
    own = {place for place, cell in enumerate(notebook.cells) if cell.source not in GIVEN}
    page, _ = exporter.from_notebook_node(make_harmless(notebook, own))
    return str(page)


@pytest.fixture
def master() -> NotebookNode:
    shown = nbformat.v4.new_markdown_cell(f"Look:\n\n{SHOWS}", attachments={"graph.png": {"image/png": DATA}})
    return nbformat.v4.new_notebook(cells=[shown])


def submitted(*texts: str) -> list[SubmittedCell]:
    return [SubmittedCell(CellType.MARKDOWN, text) for text in texts]


@pytest.mark.parametrize("chapter", sorted(CHAPTERS.glob("*/lab_*.ipynb")), ids=lambda path: path.stem)
def test_a_page_shows_every_figure_of_the_chapter(chapter: Path) -> None:
    notebook = nbformat.read(chapter, as_version=4)
    figures = [data["image/png"] for cell in notebook.cells for data in cell.get("attachments", {}).values()]
    cells = [
        SubmittedCell(
            CellType(cell.cell_type), cell.source, cell.metadata.get("nbgrader", {}).get("grade_id", "")
        )
        for cell in notebook.cells
    ]
    for rebuilt in (rebuild(notebook, cells), rebuild_unreadable(notebook, "It is a poem.")):
        page, _ = HTMLExporter(filters={"markdown2html": markdown_to_html}).from_notebook_node(
            make_harmless(rebuilt)
        )
        assert page.count(PICTURE) == len(figures) > 0
        assert all(figure in page for figure in figures)
        assert "picture left out" not in page


def pasted(text: str, *pictures: tuple[str, str, str]) -> SubmittedCell:
    return SubmittedCell(CellType.MARKDOWN, text, pictures=pictures)


@pytest.mark.parametrize("kind", ["image/png", "image/jpeg"])
@pytest.mark.parametrize(
    "words", ["", "<b>Look</b> ", "\n\n![svg](attachment:drawn.svg)\n\n", "- in a list: "]
)
def test_a_picture_that_a_student_has_pasted_is_shown(master: NotebookNode, kind: str, words: str) -> None:
    cell = pasted(f"{words}![mine](attachment:0b9f-shot.png) {SHOWS}", ("0b9f-shot.png", kind, SHOT))
    rebuilt = rebuild(master, [cell])
    page = page_of(rebuilt)
    assert page.count(f'src="data:{kind};base64,{SHOT}"') == 1
    assert page.count(f"{PICTURE}{DATA}") == 1
    assert ("(attachment:drawn.svg)" in page) is ("svg" in words)


MENTIONED = '`<img src="attachment:x.png">` &lt;img src="attachment:x.png"&gt; src="attachment:x.png" '
OWN = ("x.png", "image/png", SHOT)
CELLS: dict[str, tuple[list[SubmittedCell], int, int]] = {
    "copies": (submitted(SHOWS, SHOWS, f"{SHOWS} {SHOWS}"), 1, 0),
    "repeated in a cell": (submitted(SHOWS * 500), 1, 0),
    "in HTML": (submitted(f"<details>\n\n{SHOWS}\n\n</details><script>fired()</script>"), 1, 0),
    "a size of its own": ([pasted('<img src="attachment:x.png" width="400"/>', OWN)], 0, 1),
    "the master's name": ([pasted(SHOWS, ("graph.png", "image/png", SHOT))], 0, 1),
    "not shown by the text": ([pasted("nothing", OWN)], 0, 0),
    "only its text": ([pasted(f"{MENTIONED} ![x](attachment:x.png)", OWN)], 0, 1),
}
"""Cells, how often the master's picture is on the page of them, and how often the student's own is."""


@pytest.mark.parametrize("kind", CELLS)
def test_a_page_shows_each_picture_once_and_only_where_a_cell_shows_it(
    master: NotebookNode, kind: str
) -> None:
    cells, data, shot = CELLS[kind]
    rebuilt = rebuild(master, cells)
    page = page_of(rebuilt)
    assert (page.count(f"{PICTURE}{DATA}"), page.count(SHOT), page.count(PICTURE)) == (
        data,
        shot,
        data + shot,
    )
    assert "<script>fired" not in page
    assert sum("attachments" in cell for cell in rebuilt.cells) == data + shot, "no other one is kept"


def test_pictures_that_would_swell_a_page_are_left_out(master: NotebookNode) -> None:
    large = base64.b64encode(base64.b64decode(DATA) + bytes(3_000_000)).decode()
    cells = [pasted("![x](attachment:x.png)" * 9, ("x.png", "image/png", large)) for _ in range(9)]
    page = page_of(rebuild(master, cells))
    assert page.count(large) == 2
    assert len(page) < 10_000_000


def test_a_picture_that_is_not_there_is_left_out(master: NotebookNode) -> None:
    """nbconvert makes no page at all, and formgrader answers 500."""
    assert "![mine](attachment:mine.png)" in page_of(
        rebuild(master, [pasted("![mine](attachment:mine.png)")])
    )
    locked = master.cells[0]
    locked.metadata["nbgrader"] = {"grade_id": "given", "locked": True, "solution": False}
    del locked["attachments"]
    assert 'alt="a graph"' in page_of(rebuild(master, []))


def test_a_locked_cell_keeps_its_own_pictures(master: NotebookNode) -> None:
    master.cells[0].metadata["nbgrader"] = {"grade_id": "given", "locked": True, "solution": False}
    remark, locked, copy = rebuild(master, submitted(SHOWS)).cells
    assert [set(cell.get("attachments", {})) for cell in (remark, locked, copy)] == [
        set(),
        {"graph.png"},
        set(),
    ]


def test_what_students_do_not_get_is_in_no_page_of_theirs(master: NotebookNode) -> None:
    """The master still has the pictures of its solutions and mark schemes."""
    master.cells[0].attachments["scheme.png"] = {"image/png": SHOT}
    hidden = "### BEGIN MARK SCHEME\n![x](attachment:other.png)\n### END MARK SCHEME"
    task = nbformat.v4.new_markdown_cell(hidden, attachments={"other.png": {"image/png": SHOT}})
    master.cells.append(task)
    page = page_of(rebuild(master, submitted("![x](attachment:scheme.png) ![x](attachment:other.png)")))
    assert SHOT not in page


def test_nothing_but_a_png_stays_attached() -> None:
    kinds = {"image/svg+xml": "<svg onload='fired()'/>", "text/html": "<b>"}
    cell = nbformat.v4.new_markdown_cell(SHOWS, attachments={"graph.png": kinds})
    cells = make_harmless(nbformat.v4.new_notebook(cells=[cell])).cells
    assert "attachments" not in cells[0]
