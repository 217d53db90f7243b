"""A text made to keep a parser busy costs a desk a second, and the grader's own process next to nothing."""

from __future__ import annotations

from typing import Any

import nbformat
import pytest
from nbconvert.exporters import HTMLExporter

from autograder.execution.executed_cells import Cell, CellType
from autograder.grading.rebuilding.submitted_notebook import HARMLESS_LENGTH
from autograder.grading.returning import rendering_trial
from autograder.grading.returning.rendering_time import too_costly
from autograder.grading.returning.sanitize import make_harmless

SIZE = 50_000


def _long(text: str) -> str:
    return (text * (SIZE // len(text) + 1))[:SIZE]


MARKDOWN = {
    name: _long(text)
    for name, text in {
        "nested HTML": "<div>",
        "nested HTML in paragraphs": "<div>\n\n",
        "formatting that stays open": "<div>"
        + "".join(f"<b a={n}>" for n in range(2_000))
        + "</div>"
        + "<p>x" * 8_000,
        "formulas that open": "\\\\(",
        "environments that open": "\\begin{a}",
        "headings": "# a\n",
        "underlined headings": "a\n=\n",
        "code that opens": "```\n",
        "code to be highlighted": "```python\n" + "a." * 20_000 + "\n```\n",
        "quotations": "> ",
        "quotations of quotations": ">> a\n> b\n",
        "emphasis": "*a_b",
        "links": "[a](",
        "brackets": "[",
        "pictures": "![a](",
        "tables": "|a|b|\n|-|-|\n",
        "lists": "- 1. ",
        "tags that open": "<",
        "attributes": '<a href="',
        "tildes": "~~a",
    }.items()
}
CODE = {
    name: _long(text)
    for name, text in {
        "attributes": "a.",
        "imports": "import a.",
        "brackets": "(",
        "quotes": "'''\"",
        "f-strings": 'f"{',
        "questions": "a?",
        "magics": "a=%b\n",
        "other languages": "%%html\n<a ",
    }.items()
}
ALL = [
    (kind, name) for kind, texts in ((CellType.MARKDOWN, MARKDOWN), (CellType.CODE, CODE)) for name in texts
]


def notebook_of(cells: list[Cell]) -> nbformat.NotebookNode:
    make: dict[CellType, Any] = {
        CellType.MARKDOWN: nbformat.v4.new_markdown_cell,
        CellType.CODE: nbformat.v4.new_code_cell,
    }
    new_notebook: Any = nbformat.v4.new_notebook
    made = new_notebook(cells=[make[cell.kind](cell.source) for cell in cells])
    made.metadata["language_info"] = {"name": "python", "pygments_lexer": "ipython3"}
    return made


def text_of(kind: CellType, name: str) -> str:
    return (MARKDOWN if kind is CellType.MARKDOWN else CODE)[name]


@pytest.mark.parametrize(("kind", "name"), ALL)
def test_what_is_shown_as_typed_is_short_on_the_page(kind: CellType, name: str) -> None:
    text = text_of(kind, name)
    notebook = make_harmless(notebook_of([Cell(text, kind, own=True) for _ in range(3)]), (0, 1, 2))
    assert text[: HARMLESS_LENGTH // 3] in notebook.cells[0].source
    assert sum(len(cell.source) for cell in notebook.cells) < HARMLESS_LENGTH + 500
    assert f"[{len(text) - HARMLESS_LENGTH // 3} more characters]" in notebook.cells[1].source
    HTMLExporter().from_notebook_node(notebook)


@pytest.mark.parametrize("name", ["links", "brackets", "pictures"])
def test_what_costs_a_filter_of_the_page_costs_the_trial(name: str) -> None:
    """Plain in the Markdown parser's eyes, and seconds in those of ``strip_files_prefix``."""
    assert too_costly([Cell(MARKDOWN[name], CellType.MARKDOWN, own=True)]) == (0,)


FILTERS = {CellType.MARKDOWN: "strip_files_prefix", CellType.CODE: "clean_html"}


@pytest.mark.parametrize("kind", FILTERS)
def test_the_trial_takes_the_steps_of_the_page(kind: CellType, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page is parsed once more when it is done, so the parser sees each text of the trial, too."""
    seen: list[str] = []

    def parse(page: str, _: str) -> None:
        seen.append(page)

    def mark(page: Any) -> str:
        return f"filtered {page}"

    monkeypatch.setattr(rendering_trial, "BeautifulSoup", parse)
    monkeypatch.setattr(rendering_trial, FILTERS[kind], mark)
    rendering_trial.render(kind, "x = 1")
    assert seen[-1].startswith("filtered ")


def test_what_comes_behind_is_shown_as_typed_too_and_what_came_before_is_not() -> None:
    bomb = MARKDOWN["formulas that open"]
    cells = [
        Cell("*fine*", CellType.MARKDOWN, own=True),
        Cell("the master's", CellType.MARKDOWN),
        Cell(bomb, CellType.MARKDOWN, own=True),
        Cell("x = 1", CellType.CODE, own=True),
        Cell("*late*", CellType.MARKDOWN, own=True),
    ]
    assert too_costly(cells) == (2, 3, 4)
    notebook = make_harmless(notebook_of(cells), (2, 3, 4))
    assert notebook.cells[0].source == "*fine*"
    assert notebook.cells[4].source == "```text\n*late*\n```"
    assert notebook.cells[3].source == "x = 1"
    page, _ = HTMLExporter().from_notebook_node(notebook)
    assert "*late*" in page
    assert '<span class="n">x</span>' not in page


def test_what_students_usually_write_is_within_it() -> None:
    text = (
        "## What I saw\n\n"
        + "The talker says *Hello* and the listener [hears it](#top), `data` too.\n\n" * 100
    )
    code = "class TalkerNode(Node):\n    def __init__(self):\n        super().__init__('talker')\n" * 50
    assert len(text) > HARMLESS_LENGTH
    cells = [Cell(text, CellType.MARKDOWN, own=True), Cell(code, CellType.CODE, own=True)]
    assert too_costly(cells) == ()


def test_every_language_is_highlighted_where_no_file_can_be_opened() -> None:
    parts = (
        "# A\n\n## B\n\n*c*\n\n| d |\n| - |\n\n$e$\n\n<b>f</b>\n\n&eacute; \u00e9 \U0001f600\n\n---\n\n* g\n"
    )
    languages = ("python", "bash", "yaml", "c++", "rust", "xml", "console", "no such language", "ipython3")
    texts = [
        *parts.split("\n\n"),
        *(f"```{language}\na: b = 1\n```" for language in languages),
        "a " * HARMLESS_LENGTH,
    ]
    kinds = (CellType.MARKDOWN, CellType.CODE)
    assert too_costly([Cell(text, kind, own=True) for text in texts for kind in kinds]) == ()


def test_a_masters_texts_cost_nothing() -> None:
    assert too_costly([Cell(MARKDOWN["formulas that open"], CellType.MARKDOWN)]) == ()
