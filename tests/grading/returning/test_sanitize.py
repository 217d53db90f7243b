"""No parser reads what a student wrote: a page shows it as typed, and takes no longer for it than for other texts."""

from __future__ import annotations

from html import unescape
from typing import Any

import mistune
import nbformat
import pygments.lexer
import pytest
from bs4 import BeautifulSoup
from nbconvert.filters.markdown_mistune import markdown2html_mistune
from nbconvert.filters.strings import strip_files_prefix

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.returning.page_exporter import PageExporter
from autograder.grading.returning.picture_sizes import PixelBudget
from autograder.grading.returning.sanitize import TYPED, as_typed, harmless_output, make_harmless
from tests.cases import cases

SIZE = 100_000
PARSED_FOR_MINUTES = cases(__file__, "PARSED_FOR_MINUTES")
EXPORTER = PageExporter()
NAMES = {"notebook": "lab", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
PYTHON = {"language_info": {"name": "python", "pygments_lexer": "ipython3"}}


def typed(text: str) -> str:
    return as_typed(text, (), PixelBudget())


def shown(html: str) -> str:
    """The text of the page's only element, as a browser reads it."""
    page = BeautifulSoup(html, "html.parser")
    assert [tag.name for tag in page.find_all()] == ["pre"]
    return page.get_text().removeprefix("\n")


TEXTS = [
    "The listener hears <topic> and List<int>, if a<b then …",
    "<!-- a --> <script>fired()</script> &lt; &#8238; </pre><b>",
    "\n\n  two empty lines, and $x^2$ [a](javascript:fired())\n\n\n```mermaid\nA\n```\n",
    "![a](attachment:x.png) [files](/files/a) data:image/png;base64,AAAA",
    TYPED + "typed like ours</pre>",
    "",
]


@pytest.mark.parametrize("text", TEXTS)
def test_each_character_is_shown_wherever_the_cell_is_rendered(text: str) -> None:
    expected = text.replace("data:image/png;base64,AAAA", "[picture left out: it is too large, or damaged]")
    for html in (typed(text), markdown2html_mistune(typed(text)), strip_files_prefix(typed(text))):
        assert shown(html.strip()) == expected


def test_a_traceback_shows_no_folder_of_the_graders_machine() -> None:
    homes = "/home/" + "grader", "/" + "root"
    lines = [
        f"{homes[0]}/c/.venv/lib/python3.12/site-packages/rclpy/node.py:3",
        f"{homes[1]}/.pyenv/lib/python3.12/ast.py",
    ]
    output = nbformat.v4.new_output("error", ename="E", evalue=lines[0], traceback=lines)
    shown = str(harmless_output(output))
    assert "grader" not in shown
    assert ".pyenv" not in shown
    assert shown.count("site-packages/rclpy/node.py:3") == 2


@pytest.mark.parametrize("kind", CellType)
@pytest.mark.parametrize("part", PARSED_FOR_MINUTES)
def test_no_lexer_and_no_parser_sees_a_students_text(
    part: str, kind: CellType, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []
    lex, parse = pygments.lexer.RegexLexer.get_tokens_unprocessed, mistune.Markdown.parse

    def lexes(self: Any, text: str, *rest: Any) -> Any:
        read.append(text)
        return lex(self, text, *rest)

    def parses(self: Any, text: str, *rest: Any) -> Any:
        read.append(text)
        return parse(self, text, *rest)

    text, given = (part * SIZE)[:SIZE], f"*given* {kind} {part.encode().hex()}"
    cells = [nbformat_nodes.cell(CellType.MARKDOWN, given, "0"), nbformat_nodes.cell(kind, text, "1")]
    notebook = make_harmless(nbformat_nodes.notebook(cells, PYTHON), {1})
    monkeypatch.setattr(pygments.lexer.RegexLexer, "get_tokens_unprocessed", lexes)
    monkeypatch.setattr(mistune.Markdown, "parse", parses)
    page = EXPORTER.page(notebook, NAMES)
    assert read == [given]
    assert "<em>given</em>" in page
    assert text.strip() in unescape(page)


def test_given_code_is_highlighted_and_a_students_is_not() -> None:
    given, own = (nbformat_nodes.cell(CellType.CODE, "import rclpy", str(place)) for place in range(2))
    given.metadata["nbgrader"] = {"grade_id": "given", "locked": True, "solution": False, "grade": False}
    page = EXPORTER.page(make_harmless(nbformat_nodes.notebook([given, own], PYTHON), {1}), NAMES)
    assert page.count('<span class="kn">import</span>') == 1
    assert page.count("import rclpy") == 1


def test_a_comment_of_a_grader_is_rendered_and_loses_no_word() -> None:
    answer = nbformat_nodes.cell(CellType.MARKDOWN, "*mine*", "0")
    answer.metadata["nbgrader"] = {
        "grade_id": "a",
        "solution": True,
        "grade": True,
        "points": 1.0,
        "score": 0.0,
    }
    answer.metadata.nbgrader["comment"] = "*Read* about List<int> <script>fired()</script>"
    page = EXPORTER.page(make_harmless(nbformat_nodes.notebook([answer], PYTHON), {0}), NAMES)
    assert "<em>Read</em> about List&lt;int&gt;" in page
    assert "<script>fired" not in page
    assert "*mine*</pre>" in page


def test_text_and_pictures_keep_their_order() -> None:
    text = "one ![first](attachment:a.png) two <img src='attachment:b.png'> three attachment:a.png"
    html = as_typed(text, ("a.png", "b.png"), PixelBudget())
    page = BeautifulSoup(html, "html.parser")
    assert [(tag["src"], tag["alt"]) for tag in page.find_all("img")] == [
        ("attachment:a.png", "first"),
        ("attachment:b.png", "picture"),
    ]
    assert page.get_text().strip() == "one  two <img src=''> three attachment:a.png"


def test_a_raw_cell_of_a_student_becomes_text() -> None:
    new: Any = nbformat.v4
    cells = make_harmless(new.new_notebook(cells=[new.new_raw_cell("<b>raw</b>")]), {0}).cells
    assert (cells[0].cell_type, shown(cells[0].source)) == ("markdown", "<b>raw</b>")
