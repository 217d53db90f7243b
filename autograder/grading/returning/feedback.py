"""The pages that go back to the students, made one after the other with templates that are read once.

They are what ``nbgrader generate_feedback`` makes; where a class has configured that otherwise, nbgrader makes them
(:mod:`autograder.grading.entering.writer`).
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import re2
from bs4 import BeautifulSoup
from jinja2 import pass_context
from nbconvert.exporters.templateexporter import TemplateExporter
from nbconvert.filters.highlight import Highlight2HTML
from nbconvert.filters.widgetsdatatypefilter import WidgetsDataTypeFilter
from nbconvert.preprocessors import CSSHTMLHeaderPreprocessor
from nbformat import NotebookNode
from nbgrader.utils import is_grade, is_solution, is_task

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.entering import gradebook
from autograder.grading.entering.journal import write_whole
from autograder.grading.pages import FeedbackExporter, markdown_to_html
from autograder.grading.rebuilding import nodes
from autograder.grading.rebuilding.rebuild import is_check
from autograder.grading.returning.page_head import mark_waiting
from autograder.grading.returning.render_cache import Remembered
from autograder.grading.returning.sanitize import is_the_masters, make_harmless

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from traitlets.config import Config

    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.entering.gradebook import NotebookState

_REMEMBERED = 1024
"""Pieces of a page of each kind; the given cells of a chapter are a few hundred."""
_REMEMBERED_CHARACTERS = 8_000_000
"""Of rendered parts of pages; those that the students of a chapter share have about a million."""
_PICTURE = re2.compile(r"(?i)<img\b[^>]*")
_ALTERNATIVE = re2.compile(r"(?i)\salt=")

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
        notebook = nodes.read_own(path.read_bytes())
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
        mark_waiting(notebook, self._directory.gradebook_url, names)
        return self._exporter.page(notebook, names)

    @functools.cached_property
    def _exporter(self) -> _PageExporter:
        make: Any = _PageExporter
        exporter: _PageExporter = make(config=self._directory.config)
        return exporter


class _PageExporter(FeedbackExporter):
    """Makes the page that :class:`FeedbackExporter` makes, and remembers the parts that many students share.

    Nbconvert copies and validates a notebook twice on its way to the template, for preprocessors that may change it.
    Here there are none, so the template is rendered from the notebook itself.
    """

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        self._parts = Remembered(_REMEMBERED_CHARACTERS)
        self._preprocessors: list[Any] = []
        css: Any = CSSHTMLHeaderPreprocessor(config=self.config)
        register: Any = self.register_preprocessor
        register(css, enabled=True)
        self._set_filter("markdown2html", _markdown_to_html)

    def page(self, notebook: NotebookNode, names: Mapping[str, Any]) -> str:
        """Make the page of one notebook.

        Args:
            notebook: As it lies in ``autograded/``, with points and comments filled in; it is changed.
            names: What the template asks of the student, the notebook and the points.
        """
        language = notebook.metadata.get("language_info", {})
        lexer = language.get("pygments_lexer", language.get("name", None))
        self._set_filter("highlight_code", _highlighter(lexer))
        self._set_filter("part_of_page", functools.partial(self._part, lexer))
        resources = self._resources.copy()
        resources["nbgrader"] = names
        rendered: str = self.template.render(nb=make_harmless(notebook), resources=resources)
        return _with_alternative_texts(rendered.lstrip("\r\n"))

    @functools.cached_property
    def _resources(self) -> dict[str, Any]:
        """What nbconvert hands to a template beside the notebook: the same for all, so made for an empty one."""
        initialise: Any = self._init_resources
        names = {"notebook": "", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
        resources: dict[str, Any] = initialise({"nbgrader": names})
        shown: Any = WidgetsDataTypeFilter(notebook_metadata={}, parent=self, resources=resources)
        self._set_filter("filter_data_type", shown)
        convert: Any = TemplateExporter.from_notebook_node  # HTMLExporter's would parse the page anew
        _, resources = convert(self, nodes.notebook([], {}), resources)
        return resources

    def _part(self, lexer: str | None, render: Callable[[], str], depends_on: Any) -> str:
        if isinstance(depends_on, NotebookNode) and is_check(depends_on):
            return render()  # its card is this student's
        return self._parts.get((lexer, depends_on), render)

    def _set_filter(self, name: str, function: Callable[..., Any]) -> None:
        register: Any = self.register_filter
        register(name, function)


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
    if all(_ALTERNATIVE.search(picture[0]) for picture in _PICTURE.finditer(page)):
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
