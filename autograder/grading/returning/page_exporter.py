"""Makes a feedback page from nbgrader's template, without anything that a browser would execute or fetch.

The top of the page has the student's name, and a table of the exercises with points. It replaces the top of nbgrader's
own page, which lacks the student's name and calls each exercise "Test cell".
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import re  # noqa: TID251  (a trusted template)
from collections import OrderedDict
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import nbgrader
import re2
from jinja2 import pass_context
from nbconvert.exporters import HTMLExporter
from nbconvert.exporters.templateexporter import TemplateExporter
from nbconvert.filters.highlight import Highlight2HTML
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from nbconvert.filters.widgetsdatatypefilter import WidgetsDataTypeFilter
from nbconvert.preprocessors import CSSHTMLHeaderPreprocessor
from nbformat import NotebookNode
from traitlets.config import Config

from autograder import exercises
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id, is_check, is_the_masters
from autograder.grading.rebuilding.trusted_master import exercise_of
from autograder.grading.returning.sanitize import TYPED, make_harmless
from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
"""The Content Security Policy of a feedback page, which lets a browser show only the text, styles and pictures inside
the page.
"""

_OURS = Path(__file__).parents[1] / "page_templates"
_FORMGRADER = Path(nbgrader.__file__).parent / "server_extensions" / "formgrader"
_NBGRADERS = _FORMGRADER / "templates"
_BOOTSTRAP = _FORMGRADER / "static" / "node_modules" / "bootstrap" / "dist" / "css"
_REMEMBERED_CHARACTERS = 8_000_000
"""The maximum length of all rendered parts of pages in the cache, in characters; enough for the parts that are the same
for all students of a chapter, which take about a million.
"""


class PageExporter(HTMLExporter):
    """Makes nbgrader's feedback page from an untrusted notebook, without scripts.

    Unlike nbgrader's own page, which loads MathJax from the network, this page loads nothing, and shows formulas as
    TeX. It is also made faster: parts that are the same for many students are rendered only once, and the notebook is
    given directly to the template, while nbconvert would copy and validate it twice for its preprocessors.
    """

    @property
    def default_config(self) -> Config:
        """The templates of this page, and nbconvert's default settings."""
        config = Config(
            {
                "PageExporter": {
                    "template_name": "autograder_feedback",
                    "extra_template_basedirs": [str(_OURS), str(_NBGRADERS)],
                    "extra_template_paths": [str(_NBGRADERS), str(_BOOTSTRAP)],
                }
            }
        )
        config.merge(super().default_config)
        return config

    def __init__(self, *args: Any, **kw: Any) -> None:
        super().__init__(*args, **kw)
        self._parts = RenderedTexts(_REMEMBERED_CHARACTERS)
        self._preprocessors: list[Any] = []
        self.register_preprocessor(CSSHTMLHeaderPreprocessor(config=self.config), enabled=True)
        self.register_filter("markdown2html", markdown_to_html)

    def default_filters(self) -> Iterator[tuple[str, Any]]:
        """Yield nbconvert's filters and the filters that this page's template adds, as pairs of name and function."""
        yield from super().default_filters()
        yield "without_scripts", without_scripts
        yield "with_summary", with_summary
        yield "cards_first", cards_first

    def page(self, notebook: NotebookNode, names: Mapping[str, Any]) -> str:
        """Return the feedback page of one notebook, as HTML.

        Args:
            notebook: The notebook from ``autograded/``, with points and comments filled in. The object is changed.
            names: The values that the template needs about the student, the notebook and the points.
        """
        language = notebook.metadata.get("language_info", {})
        lexer = language.get("pygments_lexer", language.get("name", None))
        self.register_filter("highlight_code", Highlight2HTML(pygments_lexer=lexer))
        self.register_filter("part_of_page", functools.partial(self._part, lexer))
        resources = self._resources.copy()
        resources["nbgrader"] = dict(names)
        rendered: str = self.template.render(nb=make_harmless(notebook), resources=resources)
        return _with_alternative_texts(rendered.lstrip("\r\n"))

    @functools.cached_property
    def _resources(self) -> dict[str, Any]:
        """The resources that nbconvert gives to a template, such as style sheets; the same for every notebook."""
        names = {"notebook": "", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
        # Set `config_dir`, because nbconvert would otherwise read custom/custom.css in the current folder.
        resources = self._init_resources({"nbgrader": names, "config_dir": str(_OURS)})
        shown = WidgetsDataTypeFilter(notebook_metadata={}, parent=self, resources=resources)
        self.register_filter("filter_data_type", shown)
        # Not HTMLExporter's own method, which would parse the whole page again.
        _, filled = TemplateExporter.from_notebook_node(self, nbformat_nodes.notebook([], {}), resources)
        return dict(filled)

    def _part(self, lexer: str | None, render: Callable[[], str], depends_on: Any) -> str:
        if isinstance(depends_on, NotebookNode) and is_check(depends_on):
            return render()  # not cached, because a check cell contains this student's card
        return self._parts.get((lexer, depends_on), render)


class RenderedTexts:
    """A cache of rendered texts, by the values from which they are made. The least recently used is dropped first.

    Args:
        characters: The maximum length of all texts together.
    """

    def __init__(self, characters: int) -> None:
        self._left = characters
        self._texts: OrderedDict[bytes, str] = OrderedDict()

    def get(self, of: Any, make: Callable[[], str]) -> str:
        """Return the text for the given values, from the cache or newly made.

        Args:
            of: The values on which the text depends. They are encoded as JSON for the key.
            make: Makes the text.
        """
        # The key is a cryptographic hash, so that no student can write a cell with the key of another text.
        key = hashlib.sha256(msgspec.json.encode(of)).digest()
        known = self._texts.get(key)
        if known is not None:
            self._texts.move_to_end(key)
            return known
        text = make()
        self._texts[key] = text
        self._left -= len(text)
        while self._left < 0:
            _, forgotten = self._texts.popitem(last=False)
            self._left += len(forgotten)
        return text


@pass_context
def markdown_to_html(context: Any, source: str) -> str:
    """Return a Markdown cell, or a grader's comment on a cell, as HTML. This replaces nbconvert's filter.

    For formgrader, ``nbgrader_config.py`` sets this filter as ``HTMLExporter.filters["markdown2html"]``. A picture that
    is not attached to the cell is left out, because an error, as from nbconvert's filter, would leave the student
    without a page.
    """
    cell = context.get("cell", {})
    page = source if source.startswith(TYPED) else _rendered(source, is_comment=source != cell.get("source"))
    # Without a limit, a wide picture would extend beyond its column on nbgrader's pages.
    page = page.replace("<img ", '<img style="max-width: 100%" ')
    return _with_pictures(page, cell.get("attachments", {}))


def _rendered(source: str, *, is_comment: bool) -> str:
    renderer = _PageRenderer(escape=is_comment)
    return without_dead_links(MarkdownWithMath(renderer=renderer).render(source))


class _PageRenderer(IPythonRenderer):
    """nbconvert's renderer without attached pictures, which are inserted later because they are slow to parse."""

    def _embed_image_or_attachment(self, src: str) -> str:
        attached = src.startswith("attachment:")
        embedded: str = super()._embed_image_or_attachment("" if attached else src)
        return embedded or src


_SHOWS_ATTACHED = re2.compile(r'(?P<before><img\b(?:\s+[\w-]+="[^"]*")*?\s+)src="attachment:(?P<name>[^"]*)"')


def _with_pictures(page: str, attached: Mapping[str, Mapping[str, str]]) -> str:
    """Return the HTML of a cell with the attached pictures inserted.

    Args:
        page: HTML in which the address of a picture is ``attachment:`` and a name.
        attached: The attachments of the cell by name.
    """

    def shown(tag: Any) -> str:
        kind, data = next(iter(attached.get(tag["name"], {}).items()), ("", ""))
        return f'{tag["before"]}src="data:{kind};base64,{data}"' if data else tag["before"]

    return _SHOWS_ATTACHED.sub(shown, page)


_SCRIPT = re.compile(r"<script\b.*?</script\s*>", re.DOTALL | re.IGNORECASE)


# The result is cached, because the head is most of a page, and the same for all students of an assignment.
@functools.lru_cache(maxsize=16)
def without_scripts(head: str) -> str:
    """Return the head of a page without scripts, and with the policy that forbids scripts.

    Args:
        head: The head of the page, from a trusted template.
    """
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}" />'
    return _SCRIPT.sub("", head).replace("<head>", f"<head>\n{policy}", 1)


_PICTURE = re2.compile(r"(?i)<img\b([^>]*)")
_ALTERNATIVE = re2.compile(r"(?i)\salt=")


def _with_alternative_texts(page: str) -> str:
    """Add missing alternative texts to pictures, as nbconvert does, but without parsing the page."""
    alternative = 'alt="No description has been provided for this image"'
    return _PICTURE.sub(
        lambda tag: tag[0] if _ALTERNATIVE.search(tag[0]) else f"<img {alternative}{tag[1]}", page
    )


WAITS = "waits_for_a_person"
"""The key of a remark for the student, such as "waits for your instructor", in a cell's nbgrader metadata. Only a cell
without final points has a remark.
"""
_BEGIN, _END = '<div id="toc">', "</div>"
_CELL = "padding: 4px 14px 4px 0; vertical-align: top; text-align: left"


def with_summary(body: str, notebook: NotebookNode, names: Mapping[str, Any]) -> str:
    """Return a page in which the student's name and a table of exercises replace nbgrader's list.

    Args:
        body: The page as HTML. Text by a student may follow nbgrader's list, but must not precede the list.
        notebook: The notebook of the page, with points filled in.
        names: The values that the template gets about the student and the points.
    """
    before, begin, rest = body.partition(_BEGIN)
    _, end, after = rest.partition(_END)
    if not end:
        return body
    lines = "".join(
        f'<tr><td style="{_CELL}">{name}</td><td style="{_CELL}; white-space: nowrap">{points}</td>'
        f'<td style="{_CELL}">{words}</td></tr>'
        for name, points, words in _lines(notebook, names)
    )
    student, name = str(names.get("student", "")), str(names.get("name", ""))
    heading = f"{name} ({student})" if name else student
    return f"{before}{begin}<p><strong>{escape(printable(heading))}</strong></p><table>{lines}</table>{end}{after}"


def cards_first(notebook: NotebookNode) -> list[tuple[bool, bool]]:
    """Move the check cells to the top of a notebook, because their outputs are the cards.

    Returns:
        For each cell, two booleans: True if a block of given cells begins with the cell, and True if a block of given
        cells ends with the cell. The page folds these blocks.
    """
    notebook.cells = sorted(notebook.cells, key=lambda cell: not is_check(cell))
    given = [is_the_masters(cell) and not is_check(cell) for cell in notebook.cells]
    return [
        (one and not before, one and not after)
        for before, one, after in zip([False, *given], given, [*given[1:], False], strict=False)
    ]


def _lines(notebook: NotebookNode, names: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield a line of the table for each cell with points: the name, the points, and a remark, as HTML."""
    for cell in notebook.cells:
        marks = cell.metadata.get("nbgrader", {})
        if not (marks.get("grade") or marks.get("task")):
            continue
        score, most = float(marks.get("score") or 0), float(marks.get("points") or 0)
        link = f'<a href="#{escape(grade_id(cell))}">{escape(_title(cell))}</a>'
        word = "✓ all points" if score >= most else "◐ some points, see below" if score > 0 else "✗ see below"
        if marks.get(WAITS):
            word = f"… {marks[WAITS]}"
        if marks.get("comment"):
            word += f', <a href="#comment-{escape(grade_id(cell))}">with a comment</a>'
        yield link, f"{score:g} of {most:g}", word
    if names.get("late_penalty"):
        yield "Being late", f"−{float(names['late_penalty']):g}", escape(str(names.get("why_late", "")))


def _title(cell: NotebookNode) -> str:
    """Return the exercise's title if the judge checks the cell; otherwise the name of the cell."""
    name = grade_id(cell)
    if is_check(cell) and is_the_masters(cell):
        with contextlib.suppress(LookupError):
            return str(exercises.get(exercise_of(name)).title)
    return name.replace("_", " ")


_LINK = re2.compile(r'(?s)<a\b[^>]*\bhref="([^"]*)"[^>]*>(.*?)</a>')
_LEADS_SOMEWHERE = re2.compile(r"#|[a-zA-Z][a-zA-Z+.-]*:")


def without_dead_links(page: str) -> str:
    """Turn links to files next to the page into plain text, because the page is sent without these files."""
    return _LINK.sub(lambda link: link[0] if _LEADS_SOMEWHERE.match(link[1]) else link[2], page)
