"""No page that is made of a submission executes, fetches, covers or leads away, whatever is in the submission."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from nbconvert.filters.markdown_mistune import markdown2html_mistune
from nbgrader.api import Gradebook
from nbgrader.converters import GenerateFeedback
from nbgrader.coursedir import CourseDirectory
from playwright.sync_api import Error

sys.path.insert(0, str(Path(__file__).parents[1] / "grading"))
from server_of_a_test import jupyter_server
from tiny_class import FakeEngine, TinyClass, make_tiny_class

from autograder.boxes.run_limits import Ended, Limits
from autograder.execution.executed_cells import Budget, CellRun, CellType, OutputCollector
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.returning.page_exporter import markdown_to_html
from autograder.grading.returning.picture_sizes import PixelBudget
from autograder.grading.returning.sanitize import TYPED, as_typed
from autograder.grading.running import execution_backends
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task

pytestmark = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning"),
]
BANK: dict[str, dict[str, str]] = tomllib.loads((Path(__file__).parent / "hostile_texts.toml").read_text())
TEXTS = [entry["text"] for entry in BANK.values()]
ELSEWHERE = re.compile(r"^(?!file:|data:|about:|http://127\.0\.0\.1:)")
# Formgrader's own page fetches this one.
MATHJAX = "https://cdnjs.cloudflare.com/ajax/libs/mathjax/"
RICH = (
    *("text/html", "text/markdown", "text/latex", "text/plain", "image/svg+xml", "image/png", "image/jpeg"),
    *("application/javascript", "application/json", "application/pdf", "text/vnd.mermaid"),
    "application/vnd.jupyter.widget-view+json",
)


class Watched:
    """A browser's page, and what happened on it that a text should not make happen."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.happened: list[str] = []
        # A piece of HTML that has done nothing leaves the page as good as new.
        self._used = False
        page.expose_function("fired", lambda: self.happened.append("runs"))
        page.on("dialog", self._dialog)
        page.context.route(ELSEWHERE, self._elsewhere)

    def _dialog(self, dialog: Any) -> None:
        self.happened.append("runs")
        dialog.dismiss()

    def _elsewhere(self, route: Any) -> None:
        request = route.request
        if request.url.startswith(MATHJAX):
            route.abort()
            return
        left = request.is_navigation_request() and request.frame == self.page.main_frame
        self.happened.append("leaves" if left else "asks")
        route.fulfill(status=204)  # nothing there: the page stays where it is

    def settle(self) -> None:
        """Let the page come to what it does by itself."""
        self.page.evaluate(SETTLE)

    def show(self, html: str) -> list[str]:
        """What happens when a page has this piece of HTML in its body."""
        if self._used:
            self.page.goto("about:blank")
        self.happened.clear()
        try:
            self.page.set_content(f"<!DOCTYPE html><html><body>{html}</body></html>")
            looked = self.page.evaluate(f"async () => {{ await ({SETTLE})(); return ({LOOK})('body'); }}")
        except Error as error:
            if "navigation" not in str(error):
                raise
            looked = ["leaves"]
        self._used = bool(self.happened or looked)
        return [*self.happened, *looked]


# After two frames all has been asked for and shown.
SETTLE = """async () => {
  await new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)));
  await new Promise(resolve => setTimeout(resolve, 0));
}"""

# What waits for a click, and what lies over the rest of the page, below an element.
LOOK = cases(__file__, "LOOK")


@pytest.fixture
def watched(page: Page) -> Watched:
    return Watched(page)


def test_the_texts_do_what_they_are_meant_to_where_nobody_cleans_them(watched: Watched) -> None:
    """Else the tests below would show nothing."""
    duds = {}
    for name, entry in BANK.items():
        happened = watched.show(markdown2html_mistune_or_as_it_is(entry["text"]))
        if entry["does"] != "nothing" and entry["does"] not in happened:
            duds[name] = happened
    assert duds == {}
    assert sum(entry["does"] != "nothing" for entry in BANK.values()) >= 50


def markdown2html_mistune_or_as_it_is(text: str) -> str:
    try:
        return str(markdown2html_mistune(text))
    except Exception:  # nbconvert gives up on a picture that is not there
        return text


@pytest.mark.parametrize("way", ["a page of nbconvert", "our page"])
def test_no_text_does_anything_once_it_is_harmless(watched: Watched, way: str) -> None:
    live = {}
    for name, entry in BANK.items():
        typed = as_typed(entry["text"], (), PixelBudget())
        html = markdown_to_html({}, typed) if way == "our page" else str(markdown2html_mistune(typed))
        if happened := watched.show(html):
            live[name] = happened
    assert live == {}


# -- whole pages
# ----------------------------------------------------------------------------------------------------


class HostileEngine(FakeEngine):
    """Cells print, show and raise every text, as messages of a kernel that says what it likes."""

    def execute(self, task: Task) -> Execution:
        execution = super().execute(task)
        # The given cells, the answers, the checks, and one of the student's own; all of them would only take long.
        talkative = [index for index, cell in enumerate(task.cells) if cell.kind is CellType.CODE][:6]
        runs = (
            CellRun(Ended.RAISED, self._outputs() if index in talkative else ())
            for index in range(len(task.cells))
        )
        return type(execution)(tuple(runs), execution.verdicts)

    def _outputs(self) -> tuple[dict[str, Any], ...]:
        limits = Limits()
        collector = OutputCollector(limits.cell_output_bytes, Budget(limits.notebook_output_bytes))
        for text in TEXTS:
            collector.handle("stream", {"name": "stderr", "text": text})
            collector.handle(
                "error", {"ename": text, "evalue": text, "traceback": [text, f"\x1b[31m{text}\x1b[0m"]}
            )
        for kind in RICH:
            for message in ("display_data", "execute_result"):
                metadata = {kind: {"isolated": True, "width": '"><script>fired()</script>'}}
                text = "\n".join(TEXTS)
                data = {kind: text if kind != "application/json" else {"a": text}}
                collector.handle(message, {"data": data, "metadata": metadata})
        return collector.outputs()


@pytest.fixture(scope="module")
def hostile_class(tmp_path_factory: pytest.TempPathFactory) -> TinyClass:
    """A class in which one student's notebook has every text in every place, graded with feedback."""
    tiny = TinyClass(make_tiny_class(tmp_path_factory.mktemp("hostile")))
    path = tiny.submit("eve", 4, 10)
    notebook = nbformat.read(path, as_version=4)
    for text in TEXTS:
        for kind in CellType:
            cell = nbformat_nodes.cell(kind, text)
            cell.metadata = {"tags": [text], "raw_mimetype": "text/html", "magics_language": text}
            notebook.cells.append(cell)
    notebook.metadata = {"title": "<script>fired()</script>", "widgets": {"x": "<script>fired()</script>"}}
    notebook.cells[-1].metadata["nbgrader"] = {"grade_id": "<script>fired()</script>", "locked": True}
    tiny.hand_in("eve", notebook)
    # A file's name is the student's, too.
    other = tiny.submit("mallory")
    other.rename(other.with_name("lab <img src=x onerror=fired()>.ipynb"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(execution_backends, "execute_all", HostileEngine().execute_all)
        tiny.grade(feedback=True)
    assert tiny.scores("eve")["lab_1_2-talker"] == 4
    return tiny


def pages(tiny: TinyClass) -> list[Path]:
    found = sorted((tiny.path / "feedback").rglob("*.html"))
    assert [page.parts[-3] for page in found] == ["eve", "mallory"]
    return found


def assert_harmless(watched: Watched) -> None:
    watched.settle()
    # What a submission brought is in the cells; the frame around them is nbgrader's.
    cells = "#notebook-container .text_cell_render, #notebook-container .output_area"
    looked = watched.page.evaluate(LOOK, f":is({cells})")
    assert watched.happened == []
    assert set(looked) <= set()
    assert (
        watched.page.locator(
            f":is({cells}) :is(script, iframe, object, embed, form, base, meta, link)"
        ).count()
        == 0
    )


def test_our_feedback(watched: Watched, hostile_class: TinyClass) -> None:
    for path in pages(hostile_class):
        watched.page.goto(path.as_uri())
        assert_harmless(watched)
    shown = watched.page.locator("body").inner_text()
    assert "onerror=fired()" in shown, "the name is to be read, but as text"


def test_feedback_by_plain_nbgrader(watched: Watched, hostile_class: TinyClass, tmp_path: Path) -> None:
    copy = TinyClass(Path(shutil.copytree(hostile_class.path, tmp_path / "copy")))
    shutil.rmtree(copy.path / "feedback")
    config = ClassDirectory(copy.path).config
    course = CourseDirectory(config=config)
    course.assignment_id = "lab_1_2"
    GenerateFeedback(coursedir=course, config=config).start()
    for path in pages(copy):
        watched.page.goto(path.as_uri())
        assert_harmless(watched)


def test_even_a_page_that_nobody_cleaned_may_not_do_anything(
    watched: Watched, hostile_class: TinyClass, tmp_path: Path
) -> None:
    """The policy in the head is a guard of its own."""
    page = pages(hostile_class)[0].read_text()
    worst = "".join(entry["text"] for entry in BANK.values() if entry["does"] in ("runs", "asks"))
    (tmp_path / "page.html").write_text(page.replace("</body>", f"{worst}</body>"))
    watched.page.goto((tmp_path / "page.html").as_uri())
    watched.settle()
    assert watched.happened == []


def test_the_card_is_whole_and_hints_open(watched: Watched, hostile_class: TinyClass) -> None:
    page = watched.page
    page.goto(pages(hostile_class)[0].as_uri())
    card = page.locator(".agc").first
    assert "4 of 10" in card.inner_text()
    plain = page.evaluate("getComputedStyle(document.body).borderTopLeftRadius")
    assert card.evaluate("card => getComputedStyle(card).borderTopLeftRadius") != plain, "styles must hold"
    hint = page.locator("details", has_text="How many points?").first
    for details in (hint, card.locator("details").first):
        before = details.evaluate("details => details.open")  # a short traceback is
        details.locator("summary").first.click()
        assert details.evaluate("details => details.open") is not before
    assert "Ten." in hint.inner_text()


@pytest.fixture
def formgrader(hostile_class: TinyClass, tmp_path: Path) -> Iterator[str]:
    """The address of a Jupyter server in the class's folder."""
    with jupyter_server(
        ["jupyter", "server"], "teacher", tmp_path, os.environ, hostile_class.path
    ) as address:
        yield address + "formgrader/{}?token=teacher"


def test_formgraders_view_of_a_submission(
    watched: Watched, formgrader: str, hostile_class: TinyClass
) -> None:
    with Gradebook(f"sqlite:///{hostile_class.path / 'gradebook.db'}") as book:
        ids = [book.find_submission_notebook("lab_1_2", "lab_1_2", who).id for who in ("eve", "mallory")]
    for submission in ids:
        watched.page.goto(formgrader.format(f"submissions/{submission}/"))
        watched.page.locator(".agc").first.wait_for()
        assert_harmless(watched)


def test_what_is_kept_is_harmless_by_itself(hostile_class: TinyClass) -> None:
    """A formgrader that was started elsewhere knows nothing of this class's configuration."""
    notebook = nbformat.read(hostile_class.path / "autograded" / "eve" / "lab_1_2" / "lab_1_2.ipynb", 4)
    own = [cell for cell in notebook.cells if not cell.metadata.get("nbgrader", {}).get("locked")]
    assert {cell.cell_type for cell in notebook.cells} == {"code", "markdown"}
    for cell in own:
        kinds = {kind for output in cell.get("outputs", []) for kind in output.get("data", {})}
        assert kinds <= {"text/plain", "image/png", "image/jpeg"}
    texts = [cell.source for cell in own if cell.cell_type == CellType.MARKDOWN]
    assert sum(text.startswith(TYPED) for text in texts) == 2 * len(TEXTS)
    given = nbformat.read(hostile_class.path / "source" / "lab_1_2" / "lab_1_2.ipynb", 4)
    rendered = [text for text in texts if not text.startswith(TYPED)]
    assert rendered[0].startswith("**Remarks of the grader**")
    assert set(rendered[1:]) <= {cell.source for cell in given.cells}
    assert "<script>fired()" not in json.dumps(notebook.metadata)
