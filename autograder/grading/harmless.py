"""What a submission wrote, made harmless for the browser of whoever reads it.

nbconvert hands raw HTML, Mermaid diagrams and any address through to the page, in nbgrader's feedback and in
formgrader alike. So a student's text is looked at with nbconvert's own Markdown parser before it is written
into ``autograded/``: plain Markdown stays as it was written, anything else is rendered, cleaned with Bleach and
kept as that HTML. The pages are cleaned once more where they are made (:mod:`autograder.grading.pages`).
"""

from __future__ import annotations

import functools
import re
from html import escape, unescape
from typing import TYPE_CHECKING, Any

from bleach.css_sanitizer import CSSSanitizer
from bleach.sanitizer import Cleaner
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from pygments.token import STANDARD_TYPES

from autograder.boxes.execution import Kind
from autograder.boxes.outputs import IMAGES
from autograder.grading import nodes

if TYPE_CHECKING:
    from nbformat import NotebookNode

LONGEST_MARKDOWN = 50_000
"""Characters of a text cell that are rendered; a longer one is shown as it was typed."""
SHOWN = (*IMAGES, "text/plain")
"""The types of output that a cell of a submission may show; none can carry code."""

_TAGS = frozenset(
    {
        "a",
        "abbr",
        "b",
        "blockquote",
        "br",
        "caption",
        "center",
        "code",
        "dd",
        "del",
        "details",
        "div",
        "dl",
        "dt",
    }
    | {
        "em",
        "h1",
        "h2",
        "h3",
        "h4",
        "h5",
        "h6",
        "hr",
        "i",
        "img",
        "input",
        "ins",
        "kbd",
        "li",
        "mark",
        "ol",
        "p",
    }
    | {
        "pre",
        "q",
        "s",
        "samp",
        "small",
        "span",
        "strike",
        "strong",
        "sub",
        "summary",
        "sup",
        "table",
        "tbody",
    }
    | {"td", "tfoot", "th", "thead", "tr", "tt", "u", "ul", "var"}
)
_ATTRIBUTES = {
    "a": {"title"},
    "abbr": {"title"},
    "details": {"open"},
    "img": {"alt", "title", "width", "height"},
    "ol": {"start"},
    "td": {"colspan", "rowspan"},
    "th": {"colspan", "rowspan"},
}
# Only what opens a page when it is clicked. No "//": it would be another host.
_LINK = re.compile(r"https?://\S+|mailto:[^\s:]+|#\S*|(?!//)[\w%./-]+(#\S*)?", re.ASCII)
_PICTURE = re.compile(r"data:image/(png|jpeg|gif|webp);base64,[A-Za-z0-9+/=\s]*", re.ASCII)
# Those that Pygments gives to pieces of code, and mistune to a block of it: others could dress a text up as a
# verdict, or lay it over the page.
_CLASSES = {name for name in STANDARD_TYPES.values() if name} | {"highlight"}
_LANGUAGE = re.compile(r"language-[\w+-]{1,30}", re.ASCII)


def make_harmless(notebook: NotebookNode) -> NotebookNode:
    """Change what a student wrote so that no browser executes, fetches or is misled by any of it.

    Cells that the master brought along stay as they are, and so do the outputs of its check cells, which the
    judge's verdict is in. Nothing else of a notebook is believed.

    Args:
        notebook: A rebuilt or graded notebook; it is changed.

    Returns:
        The same notebook.
    """
    for cell in notebook.cells:
        if not is_the_masters(cell):
            if cell.cell_type == Kind.MARKDOWN:
                cell.source = harmless_markdown(cell.source)
            elif cell.cell_type == Kind.RAW:
                cell.update(nodes.cell(Kind.MARKDOWN, as_typed(cell.source)) | {"id": cell.id})
        if cell.cell_type == Kind.CODE and not _is_check(cell):
            cell.outputs = [_harmless_output(output) for output in cell.outputs]
    return notebook


def is_the_masters(cell: Any) -> bool:
    """Whether a cell of a rebuilt notebook is the master's, word for word."""
    marks = cell.get("metadata", {}).get("nbgrader", {})
    return bool(marks.get("locked")) and not marks.get("solution")


# Most text cells of a class are the ones that were handed out: looked at once, not once a student.
@functools.lru_cache(maxsize=1024)
def harmless_markdown(source: str) -> str:
    """Markdown that says the same as ``source`` and can do nothing.

    Args:
        source: Whatever a student typed into a text cell.
    """
    if len(source) > LONGEST_MARKDOWN:
        return as_typed(source)
    try:
        looking = _Looking()
        rendered = MarkdownWithMath(renderer=looking).render(source)
        cleaned = clean(rendered)
        if looking.is_plain and cleaned.count("&lt;") == rendered.count("&lt;"):
            return source
        if cleaned.strip() == source:
            return source  # it has been here before
        block = f"<div>{_in_one_line(cleaned)}</div>"
        return block if _as_shown(block).strip() == block else as_typed(source)
    except Exception:  # what is nested too deeply, for one; a parser may raise anything on hostile text
        return as_typed(source)


def as_typed(source: str) -> str:
    """Markdown that shows ``source`` letter by letter."""
    fence = "`" * (3 + max((len(run) for run in re.findall(r"`+", source)), default=0))
    if len(source) > LONGEST_MARKDOWN:
        source = f"{source[:LONGEST_MARKDOWN]}\n[{len(source) - LONGEST_MARKDOWN} more characters]"
    return f"{fence}text\n{source}\n{fence}"


def _in_one_line(page: str) -> str:
    """HTML without line breaks: a blank line would end the block, and Markdown would be read again behind it."""
    pieces = re.split(r"(<pre\b.*?</pre>)", page.strip(), flags=re.DOTALL)
    return "".join(("&#10;" if i % 2 else " ").join(piece.splitlines()) for i, piece in enumerate(pieces))


@functools.lru_cache(maxsize=1024)
def clean(page: str) -> str:
    """A piece of HTML with nothing in it but text, its structure, links and pictures that it brings along."""
    return Cleaner(
        tags=_TAGS,
        attributes=_may_stay,
        protocols={"http", "https", "mailto", "data"},
        css_sanitizer=CSSSanitizer(allowed_css_properties=["text-align"]),
    ).clean(page)


def _may_stay(tag: str, name: str, value: str) -> bool:
    if name == "class":
        return all(word in _CLASSES or _LANGUAGE.fullmatch(word) for word in value.split())
    if name == "style":  # mistune's way of aligning a column
        return tag in ("td", "th")
    if tag == "input":  # a task list's box; it cannot be ticked or typed into
        return name == "disabled" or (name == "type" and value == "checkbox")
    if tag == "a" and name == "href":
        return _LINK.fullmatch(unescape(value)) is not None
    if tag == "img" and name == "src":
        return _PICTURE.fullmatch(unescape(value)) is not None
    return name in _ATTRIBUTES.get(tag, ())


class _Looking(IPythonRenderer):
    """Renders as nbconvert does, and notes whatever is more than plain Markdown."""

    def __init__(self) -> None:
        super().__init__(escape=False, exclude_anchor_links=True)
        self.is_plain = True

    def block_html(self, html: str) -> str:
        """HTML on lines of its own."""
        self.is_plain = False
        return super().block_html(html)

    def inline_html(self, html: str) -> str:
        """HTML within a line."""
        self.is_plain = False
        return super().inline_html(html)

    def block_mermaidjs(self, code: str) -> str:
        """A diagram, which nbconvert writes into the page without escaping it."""
        self.is_plain = False
        return f"<pre>{escape(code)}</pre>"

    def link(self, text: str, url: str, title: str | None = None) -> str:
        """A link."""
        if not _LINK.fullmatch(unescape(url)):
            self.is_plain = False
        return super().link(text, url, title)

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """A picture: one that comes from elsewhere would tell who reads the page, and when."""
        if not _PICTURE.fullmatch(url):
            self.is_plain = False
            return f"<em>[picture left out: {escape(text)}]</em>"
        return super().image(text, url, title)


def _as_shown(markdown: str) -> str:
    """What nbconvert will make of it."""
    return MarkdownWithMath(renderer=IPythonRenderer(escape=False)).render(markdown)


def _is_check(cell: Any) -> bool:
    return is_the_masters(cell) and bool(cell.metadata.nbgrader.get("grade"))


def _harmless_output(output: NotebookNode) -> NotebookNode:
    if "data" in output:
        output.data = {kind: output.data[kind] for kind in SHOWN if kind in output.data}
        output.metadata = {}
    return output
