"""A page is the same whether its parts are remembered from other students' pages or made for it alone."""

from __future__ import annotations

import functools
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from tiny_class import TALKER, TinyClass

from autograder.execution.executed_cells import CellType
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.classes.gradebook_reading import CellEntry, SubmissionEntry
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.returning import feedback_pages
from autograder.grading.returning.page_exporter import POLICY, PageExporter, RenderedTexts

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from nbformat import NotebookNode

_SCRIPT = "<script>document.title = 'taken'</script>"


def marked(cell: NotebookNode, **marks: object) -> NotebookNode:
    cell.metadata["nbgrader"] = {
        "grade_id": TALKER,
        "locked": True,
        "solution": False,
        "grade": False,
        **marks,
    }
    return cell


def one_of_each() -> list[NotebookNode]:
    """A cell of each kind that a graded notebook can have."""
    answer = marked(
        nbformat_nodes.cell(CellType.CODE, "def talk():\n    return 10", "1"), solution=True, locked=False
    )
    answer["outputs"] = [
        nbformat_nodes.output(output_type="stream", name="stdout", text="\x1b[31mred\x1b[0m <b>\n"),
        nbformat_nodes.output(
            output_type="display_data",
            data={"text/plain": "p", "text/html": _SCRIPT, "image/png": "iVBORw0KGgo="},
            metadata={},
        ),
        nbformat_nodes.output(output_type="error", ename="E", evalue="v", traceback=["line 1", "line 2"]),
    ]
    check = marked(nbformat_nodes.cell(CellType.CODE, "check()", "2"), grade=True, points=1.0)
    check["outputs"] = [
        nbformat_nodes.output(
            output_type="display_data", data={"text/html": "<p>card</p>", "text/plain": "card"}, metadata={}
        ),
        nbformat_nodes.output(
            output_type="execute_result", data={"text/plain": "1"}, metadata={}, execution_count=None
        ),
    ]
    return [
        nbformat_nodes.cell(CellType.MARKDOWN, "# Given\n\nwith *words*", "0"),
        answer,
        check,
        marked(nbformat_nodes.cell(CellType.CODE, "print(1)", "3")),
        nbformat_nodes.cell(CellType.RAW, "raw text", "4"),
    ]


def change_source(cells: list[NotebookNode]) -> None:
    cells[1]["source"] = f"def talk():\n    return '{_SCRIPT}'"


def change_output(cells: list[NotebookNode]) -> None:
    cells[1].outputs[0]["text"] = "green\n"


def change_card(cells: list[NotebookNode]) -> None:
    cells[2].outputs[0].data["text/html"] = "<p>another card</p>"


def change_count(cells: list[NotebookNode]) -> None:
    cells[3]["execution_count"] = 7


def change_lock(cells: list[NotebookNode]) -> None:
    """The same text as the master's own and as the student's copy of it: only the first is folded away."""
    marked(cells[0])


def change_output_type(cells: list[NotebookNode]) -> None:
    cells[1].outputs[0]["name"] = "stderr"


def change_id(cells: list[NotebookNode]) -> None:
    cells[3]["id"] = "9"


def drop(cells: list[NotebookNode]) -> None:
    cells.pop(1)


def keep(cells: list[NotebookNode]) -> None:
    del cells


CHANGES = [keep, change_source, change_output, change_card, change_count, change_lock, change_output_type]
CHANGES += [change_id, drop]


def entered(cell: CellEntry) -> SubmissionEntry:
    return SubmissionEntry(cells={"lab_1_2": {TALKER: cell}})


class Pages:
    """Pages of one class, of notebooks that are put into ``autograded/`` by hand."""

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.directory = ClassDirectory(path)
        self.entry = entered(CellEntry(2.0, judged=1.0))
        monkeypatch.setattr(feedback_pages, "read_entry", lambda *_: self.entry)

    def make(
        self, maker: feedback_pages.FeedbackPages, change: Callable[[Any], None], **metadata: Any
    ) -> str:
        cells = one_of_each()
        change(cells)
        notebook = nbformat_nodes.notebook(cells, {"language_info": {"name": "python", **metadata}})
        submission = Submission("ada", "lab_1_2", self.directory.path / "submitted" / "ada" / "lab_1_2")
        folder = self.directory.path / "autograded" / "ada" / "lab_1_2"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "lab_1_2.ipynb").write_text(nbformat_nodes.text(notebook))
        maker.write(submission, ["lab_1_2"])
        return (self.directory.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").read_text()

    def fresh(self, change: Callable[[Any], None], **metadata: Any) -> str:
        """Made by somebody who remembers no other page."""
        return self.make(self._forgetful, change, **metadata)

    @functools.cached_property
    def _forgetful(self) -> feedback_pages.FeedbackPages:
        maker = feedback_pages.FeedbackPages(self.directory)
        maker._exporter._parts = RenderedTexts(0)
        return maker


@pytest.fixture
def pages(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> Pages:
    return Pages(tiny.path, monkeypatch)


def test_no_page_has_a_part_of_another_one(pages: Pages) -> None:
    expected = {change: pages.fresh(change) for change in CHANGES}
    assert len(set(expected.values())) == len(CHANGES), "each of them shows on the page"
    for page in expected.values():
        assert (page.startswith("<!DOCTYPE html>"), page.count(POLICY)) == (True, 1)
        assert "<script" not in page.lower(), "no page runs anything"
    maker = feedback_pages.FeedbackPages(pages.directory)
    for change in [*CHANGES, *reversed(CHANGES)]:
        assert pages.make(maker, change) == expected[change], change.__name__


def test_points_comments_and_language_show_in_remembered_parts(pages: Pages) -> None:
    entries = [
        entered(CellEntry(2.0, judged=1.0)),
        entered(CellEntry(3.0, judged=1.0)),
        replace(entered(CellEntry(2.0, judged=0.5, comment="well done")), penalties={"lab_1_2": 0.25}),
        entered(CellEntry(2.0, judged=0.5, comment=f"well {_SCRIPT} done")),
    ]
    kinds: list[dict[str, Any]] = [{}, {"pygments_lexer": "ipython3"}, {"name": "c"}]
    maker = feedback_pages.FeedbackPages(pages.directory)
    seen = []
    for _ in range(2):
        for entry in entries:
            for kind in kinds:
                pages.entry = entry
                seen.append(pages.make(maker, keep, **kind))
                assert seen[-1] == pages.fresh(keep, **kind)
    assert len(set(seen)) > len(entries)
    assert "well done" in seen[6]


def test_what_the_chapter_gives_is_rendered_once(pages: Pages, monkeypatch: pytest.MonkeyPatch) -> None:
    maker = feedback_pages.FeedbackPages(pages.directory)
    pages.make(maker, keep)
    rendered = []
    usual = PageExporter._part

    def noting(self: Any, lexer: str, render: Callable[[], str], depends_on: Any) -> str:
        def noted() -> str:
            rendered.append(depends_on)
            return render()

        return usual(self, lexer, noted, depends_on)

    monkeypatch.setattr(PageExporter, "_part", noting)
    pages.make(maker, keep)
    assert [cell.id for cell in rendered] == ["2"], "only the check: its card is this student's"
    pages.make(maker, change_count)
    assert [cell.id for cell in rendered[1:]] == ["2", "3"]


def test_what_opens_at_a_click_keeps_its_mark() -> None:
    """Bootstrap's rule for ``summary`` is in the page's head too; the last one holds."""
    text = nbformat_nodes.cell(
        CellType.MARKDOWN, "<details><summary>Yes</summary>\n\n✓ Because.\n</details>", "1"
    )
    names = {"notebook": "summary", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
    page = PageExporter().page(nbformat_nodes.notebook([text], {}), names)
    head, body = page.split("</head>")
    displays = re.findall(r"(?<![\w.-])summary\s*\{\s*display:\s*([\w-]+)", head)
    assert displays[-1:] == ["list-item"]
    assert "<summary>Yes</summary>" in body


def test_a_page_begins_with_the_cards_and_folds_the_text_of_the_lab(pages: Pages) -> None:
    page = pages.fresh(change_lock)
    body = page[page.index("</table>") :]
    parts = re.split(r"<details><summary>Text of the lab</summary>|</details>", body)
    shown, folded = "".join(parts[::2]), "".join(parts[1::2])
    assert "<p>card</p>" in parts[0]
    assert "talk" in shown
    assert "Given" not in shown
    assert ("Given" in folded, "card" in folded, "talk" in folded) == (True, False, False)
    assert len(parts) == 5, "the text before the answer, and the one behind it"
