"""Makes a submission's texts and outputs harmless for a browser.

nbconvert copies raw HTML, Mermaid diagrams and any address into nbgrader's feedback pages and formgrader. So a
student's text is parsed with nbconvert's own Markdown parser before it is written into ``autograded/``. If it is plain
Markdown, it stays unchanged; otherwise it is rendered, cleaned with nh3, and stored as HTML. Feedback pages are cleaned
again when they are made (:mod:`autograder.grading.returning.page_exporter`).
"""

from __future__ import annotations

import functools
from html import escape, unescape
from typing import TYPE_CHECKING, Any

import nh3
import re2
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from pygments.token import STANDARD_TYPES

from autograder.execution.executed_cells import IMAGES, CellType
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import is_check, is_the_masters
from autograder.grading.rebuilding.submitted_notebook import HARMLESS_LENGTH
from autograder.grading.returning.browser_memory import PixelBudget, may_be_shown, positions_in_tables

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from nbformat import NotebookNode

LONGEST_MARKDOWN = 50_000
"""The maximum length of a text cell to render, in characters. A longer text is shown as typed."""
_MOST_POSITIONS = 50_000
"""The maximum size of all tables in a text, as rows times columns. It is limited because a browser needs memory for
each position in a table, even if the position has no cell.
"""
SHOWN = (*IMAGES, "text/plain")
"""The media types that an output of a student's cell may have, because they cannot contain scripts."""

_FORMATTING = frozenset(("a", "b", "code", "em", "i", "s", "small", "strike", "strong", "tt", "u"))
"""The formatting elements of HTML, which a parser opens again in each following block if they are not closed."""
_TAGS = _FORMATTING | {
    *("abbr", "blockquote", "br", "caption", "center", "dd", "del", "details", "div", "dl", "dt"),
    *("h1", "h2", "h3", "h4", "h5", "h6", "hr", "img", "input", "ins", "kbd", "li", "mark", "ol", "p", "pre"),
    *("q", "samp", "span", "sub", "summary", "sup", "table", "tbody", "td", "tfoot", "th", "thead", "tr"),
    *("ul", "var"),
}
_ATTRIBUTES = {
    "a": {"href", "title"},
    "abbr": {"title"},
    "details": {"open"},
    "img": {"alt", "height", "src", "title", "width"},
    "input": {"disabled", "type"},  # the disabled checkbox of a task list in Markdown
    "ol": {"start"},
    "td": {"colspan", "rowspan", "style"},  # mistune writes the alignment of a table cell into `style`
    "th": {"colspan", "rowspan", "style"},
    "*": {"class"},
}
_MOST_OPENED = 200_000
"""The maximum number of elements that a parser may make because of unclosed formatting. The course's own texts need up
to 1,700.
"""
# Matches the beginning of a comment, a whole tag (with ">" allowed inside quotation marks), or any other "<".
_MARKUP = re2.compile(r"""<!--|</?([a-zA-Z][^\s/>]*)(?:[^<>"']|"[^"]*"|'[^']*')*>|<""")
# Matches the beginning of a tag, up to its end or its first quotation mark.
_TAG = re2.compile(r"""<([a-zA-Z][^\s/>]*)[^<>"']*["']?""")
_CONTROL = dict.fromkeys((*range(1, 9), 11, 12, *range(14, 32)), "?")
# Matches the allowed addresses of links: pages, email addresses, and places in this page. An address such as
# "//host/page" is not allowed, because it leads to another host.
_LINK = re2.compile(r"https?://\S+|mailto:[^\s:]+|#\S*|(/|/?[\w%.-][\w%./-]*)(#\S*)?")
_PICTURE = re2.compile(r"data:image/(?:png|jpeg|gif|webp);base64,([A-Za-z0-9+/=\s]*)")
_ATTACHED = "attachment:"
_ATTACHMENT = re2.compile(rf"{_ATTACHED}[\w.%+-]+")
# Only the CSS classes that Pygments and mistune give to code are allowed, because with other classes, a text could look
# like a verdict, or cover the page.
_CLASSES = {name for name in STANDARD_TYPES.values() if name} | {"highlight"}
_LANGUAGE = re2.compile(r"language-[\w+-]{1,30}")


_DIRECTION_ESCAPES = {
    code: f"\\u{code:04x}"
    for code in (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))
}
"""The characters that change the writing direction, each with the escape to show instead. They are replaced because
with them, a text may look different from its real content (Unicode TR 36, "Bidirectional Text").
"""


def escape_direction_marks(text: str) -> str:
    """Return ``text`` with escapes for the characters that change the writing direction."""
    return text if text.isascii() else text.translate(_DIRECTION_ESCAPES)


def make_harmless(notebook: NotebookNode, as_they_are: Collection[int] = ()) -> NotebookNode:
    """Remove everything from a student's texts and outputs that a browser could execute or load, or that misleads.

    The text of the master's cells and the outputs of its check cells, which show verdicts, stay unchanged; but pictures
    that are too large are removed everywhere.

    Args:
        notebook: A rebuilt or graded notebook. It is changed.
        as_they_are: The indexes of cells that take too long to render, which are therefore shown as typed. They are
            also cut to a total length, because nbconvert's filters read even such cells.

    Returns:
        The same notebook.
    """
    longest = _longest_shown([len(cell.source) for n, cell in enumerate(notebook.cells) if n in as_they_are])
    pictures = PixelBudget()
    for index, cell in enumerate(notebook.cells):
        if not is_the_masters(cell):
            cell.source = escape_direction_marks(cell.source)
            if index in as_they_are:
                cell.source = _cut(cell.source, longest)
                _show_as_typed(cell)
            else:
                _make_text_harmless(cell, pictures)
        if cell.cell_type == CellType.CODE:
            shows_verdict = is_check(cell) and is_the_masters(cell)
            outputs = cell.outputs if shows_verdict else map(harmless_output, cell.outputs)
            cell.outputs = [_with_pictures_that_fit(output, pictures) for output in outputs]
    return notebook


def _make_text_harmless(cell: NotebookNode, pictures: PixelBudget) -> None:
    if cell.cell_type == CellType.MARKDOWN:
        cell.source = harmless_markdown(cell.source, _figures(cell))
        if not pictures.fit(_pictures_of(cell)):
            cell.pop("attachments", None)
            cell.source = _as_typed(_PICTURE.sub("picture left out: too large", cell.source))
    elif cell.cell_type == CellType.RAW:
        _show_as_typed(cell)


def _show_as_typed(cell: NotebookNode) -> None:
    if cell.cell_type == CellType.CODE:
        cell.metadata["magics_language"] = "text"  # so that nbconvert shows the code without highlighting
    elif cell.cell_type == CellType.RAW:
        cell.update(nbformat_nodes.cell(CellType.MARKDOWN, _as_typed(cell.source)) | {"id": cell.id})
    else:
        cell.source = _as_typed(cell.source)


def _pictures_of(cell: NotebookNode) -> list[str]:
    """Return the attached and embedded pictures of a text cell in base64, without duplicates."""
    attached = [data for kinds in cell.get("attachments", {}).values() for data in kinds.values()]
    return [*attached, *{found[1] for found in _PICTURE.finditer(cell.source)}]


def _with_pictures_that_fit(output: NotebookNode, pictures: PixelBudget) -> NotebookNode:
    """Return an output in which a sentence replaces each picture that is invalid or too large."""
    for kind in IMAGES:
        encoded = output.get("data", {}).get(kind)
        if encoded is not None and not (may_be_shown(text := "".join(encoded)) and pictures.fit([text])):
            del output.data[kind]
            output.data["text/plain"] = "[picture left out: it is too large, or damaged]"
    return output


# The result is cached, because most students leave most text cells unchanged.
@functools.lru_cache(maxsize=1024)
def harmless_markdown(source: str, figures: tuple[str, ...] = ()) -> str:
    """Return Markdown that shows the same text as ``source``, without scripts, foreign pictures or misleading markup.

    Args:
        source: The text of a student's text cell.
        figures: The names of the bitmaps attached to the cell, each of which may be shown once.
    """
    if len(source) > LONGEST_MARKDOWN:
        return _as_typed(source)
    try:
        renderer = _InspectingRenderer(figures)
        rendered = MarkdownWithMath(renderer=renderer).render(source)
        if escape_direction_marks(plain := unescape(rendered)) != plain:
            return _as_typed(source)  # an HTML entity changes the writing direction
        cleaned = clean(rendered)
        if renderer.is_plain and cleaned.count("&lt;") == rendered.count("&lt;"):
            return source
        if (in_one_line := _in_one_line(cleaned)) == source:
            return source  # the text was cleaned earlier
        block = f"<div>{in_one_line}</div>"
        # Store the block only if nbconvert shows it unchanged.
        shown = MarkdownWithMath(renderer=IPythonRenderer(escape=False)).render(block)
        return block if shown.strip() == block else _as_typed(source)
    except Exception:  # a parser may raise any error for a hostile text, for example because of deep nesting
        return _as_typed(source)


def _as_typed(source: str) -> str:
    """Return Markdown that shows ``source`` unchanged, as a code block; very long text is cut."""
    fence = "`" * (3 + max((len(run) for run in re2.findall(r"`+", source)), default=0))
    return f"{fence}text\n{_cut(source, LONGEST_MARKDOWN)}\n{fence}"


def _figures(cell: Any) -> tuple[str, ...]:
    """Remove all attachments of a text cell except bitmaps, and return the names of the bitmaps."""
    attached = cell.pop("attachments", {})
    bitmaps = {
        name: {kind: data}
        for name, kinds in attached.items()
        for kind, data in kinds.items()
        if kind in IMAGES and _is_picture(f"data:{kind};base64,{data}")
    }
    if bitmaps:
        cell["attachments"] = bitmaps
    return tuple(bitmaps)


def _longest_shown(lengths: Iterable[int]) -> int:
    """Return the length to which texts must be cut so that together they have at most ``HARMLESS_LENGTH``."""
    left, fewest_first = HARMLESS_LENGTH, sorted(lengths)
    for index, length in enumerate(fewest_first):
        share = left // (len(fewest_first) - index)
        if length > share:
            return share
        left -= length
    return HARMLESS_LENGTH


def _cut(source: str, length: int) -> str:
    return source if len(source) <= length else f"{source[:length]}\n[{len(source) - length} more characters]"


def _in_one_line(page: str) -> str:
    """Return HTML without line breaks, because a Markdown parser would read what follows an empty line as Markdown."""
    pieces = re2.split(r"(?s)(<pre\b.*?</pre>)", page.strip())
    return "".join(("&#10;" if i % 2 else " ").join(piece.splitlines()) for i, piece in enumerate(pieces))


@functools.lru_cache(maxsize=1024)
def clean(page: str) -> str:
    """Return HTML reduced to allowed elements: text, structure, links and embedded pictures.

    A forbidden tag is shown as text, because a text such as "List<int>" would lose its meaning if the tag were removed.
    """
    if _may_open(page) > _MOST_OPENED:
        return f"<pre>{escape(page)}</pre>"
    cleaned = _CLEANER.clean(_MARKUP.sub(_shown_or_kept, page).translate(_CONTROL))
    return cleaned if positions_in_tables(cleaned) <= _MOST_POSITIONS else f"<pre>{escape(page)}</pre>"


def _may_open(page: str) -> int:
    """Return the maximum number of elements that nh3 could make because formatting elements are not closed.

    This is needed because at each tag, nh3 opens each kind of unclosed formatting again, up to three times per kind. So
    for a text of 50,000 characters, nh3 can make gigabytes of elements, and nothing can interrupt nh3.
    """
    tags = list(_TAG.finditer(page))
    formatting = [tag[0] for tag in tags if tag[1].lower() in _FORMATTING]
    # Each tag with a quotation mark counts as a kind of its own, because `_TAG` reads a tag only up to its first
    # quotation mark.
    kinds = {tag for tag in formatting if tag[-1] not in "\"'"}
    return len(tags) * (3 * len(kinds) + sum(tag not in kinds for tag in formatting))


def _shown_or_kept(markup: Any) -> str:
    """Return an allowed tag, or the beginning of a comment, unchanged. Return any other markup escaped as text."""
    stays = markup[0] == "<!--" or (markup[1] or "").lower() in _TAGS
    return markup[0] if stays else markup[0].replace("<", "&lt;")


def _is_picture(address: str) -> bool:
    """Return True if an address is a data URL with a picture that a page may show."""
    found = _PICTURE.fullmatch(address)
    return found is not None and may_be_shown(found[1])


def _value_that_may_stay(tag: str, name: str, value: str) -> str | None:
    match tag, name:
        case _, "class":
            stays = all(word in _CLASSES or _LANGUAGE.fullmatch(word) for word in value.split())
        case "input", "type":
            stays = value == "checkbox"
        case _, "colspan" | "rowspan":
            stays = re2.fullmatch("[0-9]{1,5}", value) is not None
        case "img", "height" | "width":
            stays = re2.fullmatch("[0-9]{1,4}(px|%)?", value) is not None
        case "a", "href":
            stays = _LINK.fullmatch(value) is not None
        case "img", "src":
            stays = _is_picture(value) or _ATTACHMENT.fullmatch(value) is not None
        case _:
            stays = True
    return value if stays else None


_CLEANER = nh3.Cleaner(
    tags=set(_TAGS),
    clean_content_tags=set(),
    attributes=_ATTRIBUTES,
    attribute_filter=_value_that_may_stay,
    filter_style_properties={"text-align"},
    url_schemes={"http", "https", "mailto", "data", _ATTACHED.rstrip(":")},
    link_rel=None,
)


class PageRenderer(IPythonRenderer):
    """nbconvert's renderer without attached pictures, which are inserted later because they are slow to parse."""

    def _embed_image_or_attachment(self, src: str) -> str:
        embedded: str = super()._embed_image_or_attachment("" if src.startswith(_ATTACHED) else src)
        return embedded or src


class _InspectingRenderer(PageRenderer):
    """nbconvert's renderer, which also sets ``is_plain`` to False if a text contains more than plain Markdown."""

    def __init__(self, figures: tuple[str, ...] = ()) -> None:
        super().__init__(escape=False, exclude_anchor_links=True)
        self.is_plain = True
        self._left = set(figures)

    def block_html(self, html: str) -> str:
        self.is_plain = False
        return super().block_html(html)

    def inline_html(self, html: str) -> str:
        self.is_plain = False
        return super().inline_html(html)

    def block_mermaidjs(self, code: str) -> str:
        """Render a diagram as text, because nbconvert would not escape it."""
        self.is_plain = False
        return f"<pre>{escape(code)}</pre>"

    def link(self, text: str, url: str, title: str | None = None) -> str:
        if not _LINK.fullmatch(unescape(url)):
            self.is_plain = False
        return super().link(text, url, title)

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """Leave out a picture on another server, because loading it would reveal who reads the page, and when."""
        if (name := url.removeprefix(_ATTACHED)) != url and name in self._left:
            self._left.remove(name)
            return super().image(text, url, title)
        if not _is_picture(url):
            self.is_plain = False
            return f"<em>[picture left out: {escape(text)}]</em>"
        return super().image(text, url, title)


def harmless_output(output: NotebookNode) -> NotebookNode:
    """Return an output of a student's cell with everything but texts and bitmaps removed."""
    if "data" in output:
        output.data = {kind: _escape_marks_in(output.data[kind]) for kind in SHOWN if kind in output.data}
        output.metadata = {}
    for words in ("text", "ename", "evalue", "traceback"):
        if words in output:
            output[words] = _escape_marks_in(output[words])
    return output


def _escape_marks_in(words: Any) -> Any:
    """Return a text, or a list of lines, with escapes for the characters that change the writing direction."""
    if isinstance(words, str):
        return escape_direction_marks(words)
    return [_escape_marks_in(line) for line in words] if isinstance(words, list) else words
