"""The pages that go back to the students, made one after the other with templates that are read once.

They are what ``nbgrader generate_feedback`` makes; where a class has configured that otherwise, nbgrader makes them
(:mod:`autograder.grading.writer`).
"""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING, Any

import nbformat
from bs4 import BeautifulSoup
from jinja2 import pass_context
from nbconvert.exporters.templateexporter import TemplateExporter
from nbconvert.filters.highlight import Highlight2HTML
from nbconvert.filters.widgetsdatatypefilter import WidgetsDataTypeFilter
from nbconvert.preprocessors import CSSHTMLHeaderPreprocessor
from nbgrader.utils import is_grade, is_solution, is_task

from autograder.grading import gradebook
from autograder.grading.class_directory import SUFFIX
from autograder.grading.harmless import is_the_masters, make_harmless
from autograder.grading.journal import write_whole
from autograder.grading.pages import FeedbackExporter, markdown_to_html

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from nbformat import NotebookNode
    from traitlets.config import Config

    from autograder.grading.class_directory import ClassDirectory, Submission
    from autograder.grading.gradebook import NotebookState

_REMEMBERED = 1024
"""Pieces of a page of each kind; the given cells of a chapter are a few hundred."""
_PICTURE_WITHOUT_WORDS = re.compile(r"<img\b(?![^>]*\salt=)", re.IGNORECASE)

_USUAL = {"exporter_class": "autograder.grading.pages.FeedbackExporter"}
_USUAL_FILTERS = {"markdown2html": "autograder.grading.pages.markdown_to_html"}
_CHANGES_PAGES = (
    "BaseConverter",
    "NbConvertBase",
    "Exporter",
    "TemplateExporter",
    "FeedbackExporter",
    "GetGrades",
    "CSSHTMLHeaderPreprocessor",
)


def is_usual(config: Config) -> bool:
    """Whether a class makes its pages as ``new-class`` has it."""
    return (
        dict(config.GenerateFeedback) == _USUAL
        and dict(config.HTMLExporter) == {"filters": _USUAL_FILTERS}
        and not any(config.get(section) for section in _CHANGES_PAGES)
    )


class FeedbackPages:
    """Makes pages for one class.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def write(self, submission: Submission, notebooks: Sequence[str]) -> None:
        """Make the page of each notebook of a graded submission.

        Args:
            submission: It is in ``autograded/`` and in the gradebook.
            notebooks: Their names.

        Raises:
            OSError: A page could not be written.
        """
        states = gradebook.states(self._directory.gradebook_url, submission.assignment, submission.student)
        graded = self._directory.path / "autograded" / submission.student / submission.assignment
        folder = self._directory.path / "feedback" / submission.student / submission.assignment
        for name in notebooks:
            page = self._page(graded / f"{name}{SUFFIX}", submission, states[name])
            write_whole(folder / f"{name}.html", page.encode())

    def _page(self, path: Path, submission: Submission, state: NotebookState) -> str:
        read: Any = nbformat.v4.reads  # without nbformat's validation: we have written it ourselves
        notebook = read(path.read_text(encoding="utf-8"))
        for cell in notebook.cells:
            _fill_in(cell, state)
        score = sum(cell.score or 0.0 for cell in state.cells.values())
        names = {
            "student": submission.student,
            "assignment": submission.assignment,
            "notebook": path.stem,
            "score": score - state.late_penalty,
            "max_score": sum(cell.max_score or 0.0 for cell in state.cells.values()),
            "late_penalty": state.late_penalty,
        }
        resources = {
            "unique_key": path.stem,
            "output_files_dir": f"{path.stem}_files",
            "nbgrader": names,
            "metadata": {"name": path.stem, "path": str(path.parent)},
        }
        page, _ = self._exporter.from_notebook_node(notebook, resources)
        return page

    @functools.cached_property
    def _exporter(self) -> _PageExporter:
        make: Any = _PageExporter
        exporter: _PageExporter = make(config=self._directory.config)
        exporter._preprocessors = []
        css: Any = CSSHTMLHeaderPreprocessor(config=self._directory.config)
        register: Any = exporter.register_preprocessor
        register(css, enabled=True)
        return exporter


class _PageExporter(FeedbackExporter):
    """Makes the page that :class:`FeedbackExporter` makes, and remembers the pieces that many students share."""

    def from_notebook_node(  # type: ignore[override]
        self, nb: NotebookNode, resources: dict[str, Any], **kw: Any
    ) -> tuple[str, dict[str, Any]]:
        """Make the page of one notebook."""
        language = nb.metadata.get("language_info", {})
        lexer = language.get("pygments_lexer", language.get("name", None))
        exporter: Any = self
        resources = exporter._init_resources(resources)
        exporter.register_filter("highlight_code", _highlighter(lexer))
        exporter.register_filter("markdown2html", _markdown_to_html)
        exporter.register_filter(
            "filter_data_type",
            WidgetsDataTypeFilter(
                notebook_metadata=exporter._nb_metadata, parent=exporter, resources=resources
            ),
        )
        convert: Any = TemplateExporter.from_notebook_node
        page, resources = convert(self, make_harmless(nb), resources, **kw)
        return _with_alternative_texts(page), resources


@functools.lru_cache(maxsize=8)
def _highlighter(lexer: str | None) -> Any:
    """Nbconvert's highlighter, which is not asked again about the same code."""
    make: Any = Highlight2HTML
    highlight = make(pygments_lexer=lexer)

    @functools.lru_cache(maxsize=_REMEMBERED)
    def highlighted(source: str, language: str | None, magics: str | None) -> Any:
        return highlight(source, language, {"magics_language": magics} if magics else {})

    def filtered(source: str, language: str | None = None, metadata: Any = None) -> Any:
        return highlighted(source, language, (metadata or {}).get("magics_language"))

    return filtered


@pass_context
def _markdown_to_html(context: Any, source: str) -> str:
    """The filter of :mod:`autograder.grading.pages`, which is not asked again about the same text."""
    cell = context.get("cell", {})
    if cell.get("attachments"):
        return markdown_to_html(context, source)
    return _rendered(source, is_the_masters(cell))


@functools.lru_cache(maxsize=_REMEMBERED)
def _rendered(source: str, trusted: bool) -> str:
    # Of the context, the filter reads only the cell.
    cell = {"metadata": {"nbgrader": {"locked": trusted}}}
    return markdown_to_html({"cell": cell}, source)


def _with_alternative_texts(page: str) -> str:
    """What nbconvert does to a whole page at the end: it parses it anew, also where no picture lacks words."""
    if not _PICTURE_WITHOUT_WORDS.search(page):
        return page
    soup = BeautifulSoup(page, features="html.parser")
    for picture in soup.select("img:not([alt])"):
        picture.attrs["alt"] = "No description has been provided for this image"
    return str(soup)


def _fill_in(cell: Any, state: NotebookState) -> None:
    """What nbgrader's GetGrades puts into a cell for the template."""
    marks: Mapping[str, Any] = cell.metadata.get("nbgrader", {})
    known = state.cells.get(marks.get("grade_id", ""))
    if known is None:
        return
    if is_solution(cell) or is_task(cell):
        cell.metadata.nbgrader["comment"] = known.comment
    if is_grade(cell) or is_task(cell):
        cell.metadata.nbgrader["score"] = known.score
        cell.metadata.nbgrader["points"] = known.max_score
