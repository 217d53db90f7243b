"""Makes a submission's texts and outputs harmless for a browser.

nbconvert passes raw HTML, Mermaid diagrams and any address to the page, in nbgrader's feedback and in formgrader. So
a student's text is checked with nbconvert's own Markdown parser before it is written into ``autograded/``: plain
Markdown stays as written; anything else is rendered, cleaned with nh3 and stored as HTML. The pages are cleaned again
when they are made (:mod:`autograder.grading.returning.page_exporter`).
"""

from __future__ import annotations

import functools
from html import escape, unescape
from typing import TYPE_CHECKING, Any

import nh3
import re2
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from pygments.token import STANDARD_TYPES

from autograder.execution.cells import CellType
from autograder.execution.outputs import IMAGES
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.rebuild import is_check, is_the_masters
from autograder.grading.rebuilding.submission import HARMLESS_LENGTH
from autograder.grading.returning.pictures import PixelBudget, is_shown
from autograder.grading.returning.tables import places_in_tables

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from nbformat import NotebookNode

LONGEST_MARKDOWN = 50_000
"""The maximum length of a text cell, in characters, that is rendered. A longer one is shown as typed."""
_MOST_PLACES = 50_000
"""The maximum number of rows times columns in a text's tables. A browser stores the borders of each position, even if
there is no cell.
"""
SHOWN = (*IMAGES, "text/plain")
"""The types of output that a submission's cell may show. None of them can contain code."""

_FORMATTING = frozenset(("a", "b", "code", "em", "i", "s", "small", "strike", "strong", "tt", "u"))
"""Elements that an HTML parser opens again in each block until they are closed."""
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
    "input": {"disabled", "type"},  # the checkbox of a task list; no reader can change it
    "ol": {"start"},
    "td": {"colspan", "rowspan", "style"},  # mistune writes the alignment into the style
    "th": {"colspan", "rowspan", "style"},
    "*": {"class"},
}
_MOST_OPENED = 200_000
"""The maximum number of elements that a parser may have to make for unclosed formatting. A text of the course needs up
to 1,700.
"""
# Matches a comment; a tag, in which a quoted ">" does not end it; or a "<" that begins neither.
_MARKUP = re2.compile(r"""<!--|</?([a-zA-Z][^\s/>]*)(?:[^<>"']|"[^"]*"|'[^']*')*>|<""")
# Matches the beginning of a tag, up to its end or its first quotation mark.
_TAG = re2.compile(r"""<([a-zA-Z][^\s/>]*)[^<>"']*["']?""")
_CONTROL = dict.fromkeys((*range(1, 9), 11, 12, *range(14, 32)), "?")
# Only links that open a page on a click are allowed. They must not begin with "//", which would be another host.
_LINK = re2.compile(r"https?://\S+|mailto:[^\s:]+|#\S*|(/|/?[\w%.-][\w%./-]*)(#\S*)?")
_PICTURE = re2.compile(r"data:image/(?:png|jpeg|gif|webp);base64,([A-Za-z0-9+/=\s]*)")
_ATTACHED = "attachment:"
_ATTACHMENT = re2.compile(rf"{_ATTACHED}[\w.%+-]+")
# The allowed CSS classes: Pygments and mistune give pieces of code no others. Other classes could make a text look like
# a verdict, or cover the page.
_CLASSES = {name for name in STANDARD_TYPES.values() if name} | {"highlight"}
_LANGUAGE = re2.compile(r"language-[\w+-]{1,30}")


_TURNS = {
    code: f"\\u{code:04x}"
    for code in (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))
}
"""Characters that change the writing direction, so that a text may look different from what it is (Unicode TR 36,
"Bidirectional Text"), each with its escape.
"""


def visible(text: str) -> str:
    """Return ``text`` with characters that change the writing direction shown as escapes."""
    return text if text.isascii() else text.translate(_TURNS)


def make_harmless(notebook: NotebookNode, as_they_are: Collection[int] = ()) -> NotebookNode:
    """Change a student's texts and outputs so that no browser executes or fetches anything or is misled.

    Cells from the master stay unchanged, and so do the outputs of the master's check cells, which show the judge's
    verdict. Nothing else in a notebook is trusted.

    Args:
        notebook: A rebuilt or graded notebook. It is changed.
        as_they_are: The indexes of cells whose text must not be rendered, because that would take too long. They are
            shown as typed. As that, too, goes through nbconvert's filters, they are cut to a total length.

    Returns:
        The same notebook.
    """
    longest = _longest_shown([len(cell.source) for n, cell in enumerate(notebook.cells) if n in as_they_are])
    pictures = PixelBudget()
    for place, cell in enumerate(notebook.cells):
        if not is_the_masters(cell):
            cell.source = visible(cell.source)
            if place in as_they_are:
                cell.source = _cut(cell.source, longest)
            if cell.cell_type == CellType.MARKDOWN:
                if place in as_they_are:
                    cell.source = as_typed(cell.source)
                else:
                    cell.source = harmless_markdown(cell.source, _figures(cell))
                    if not pictures.fit(_pictures_of(cell)):
                        cell.pop("attachments", None)
                        cell.source = as_typed(_PICTURE.sub("picture left out: too large", cell.source))
            elif cell.cell_type == CellType.RAW:
                cell.update(nbformat_nodes.cell(CellType.MARKDOWN, as_typed(cell.source)) | {"id": cell.id})
            elif place in as_they_are:
                cell.metadata["magics_language"] = (
                    "text"  # with this value, nbconvert does not highlight the code
                )
        if cell.cell_type == CellType.CODE and not (is_check(cell) and is_the_masters(cell)):
            cell.outputs = [_with_pictures_that_fit(harmless_output(o), pictures) for o in cell.outputs]
    return notebook


def _pictures_of(cell: NotebookNode) -> list[str]:
    """Return the pictures of a text cell in base64; each picture once, however often the text shows it."""
    attached = [data for kinds in cell.get("attachments", {}).values() for data in kinds.values()]
    return [*attached, *{found[1] for found in _PICTURE.finditer(cell.source)}]


def _with_pictures_that_fit(output: NotebookNode, pictures: PixelBudget) -> NotebookNode:
    """Return an output in which a sentence replaces each picture that a page may not show. The output is changed."""
    for kind in IMAGES:
        encoded = output.get("data", {}).get(kind)
        if encoded is not None and not (is_shown(text := "".join(encoded)) and pictures.fit([text])):
            del output.data[kind]
            output.data["text/plain"] = "[picture left out: it is too large, or damaged]"
    return output


# The result is cached, because most text cells of a class are unchanged: they are checked once, not once per student.
@functools.lru_cache(maxsize=1024)
def harmless_markdown(source: str, figures: tuple[str, ...] = ()) -> str:
    """Return Markdown with the same text as ``source`` that can do nothing harmful.

    Args:
        source: A student's text cell.
        figures: The names of the bitmaps attached to the cell. A bitmap may be shown once.
    """
    if len(source) > LONGEST_MARKDOWN:
        return as_typed(source)
    try:
        looking = _Looking(figures)
        rendered = MarkdownWithMath(renderer=looking).render(source)
        if visible(plain := unescape(rendered)) != plain:
            return as_typed(source)  # a change of the writing direction may also be written as an entity
        cleaned = clean(rendered)
        if looking.is_plain and cleaned.count("&lt;") == rendered.count("&lt;"):
            return source
        if (in_one_line := _in_one_line(cleaned)) == source:
            return source  # this text is the result of an earlier cleaning
        block = f"<div>{in_one_line}</div>"
        return block if _as_shown(block).strip() == block else as_typed(source)
    except Exception:  # for example because of too deep nesting; on hostile text a parser may raise anything
        return as_typed(source)


def as_typed(source: str) -> str:
    """Return Markdown that shows ``source`` literally."""
    fence = "`" * (3 + max((len(run) for run in re2.findall(r"`+", source)), default=0))
    return f"{fence}text\n{_cut(source, LONGEST_MARKDOWN)}\n{fence}"


def _figures(cell: Any) -> tuple[str, ...]:
    """Return the names of the bitmaps attached to a text cell; remove all other attachments."""
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
    """Return the length to which texts of these lengths have to be cut, so that all of them together are harmless."""
    left, fewest_first = HARMLESS_LENGTH, sorted(lengths)
    for place, length in enumerate(fewest_first):
        share = left // (len(fewest_first) - place)
        if length > share:
            return share
        left -= length
    return HARMLESS_LENGTH


def _cut(source: str, length: int) -> str:
    return source if len(source) <= length else f"{source[:length]}\n[{len(source) - length} more characters]"


def _in_one_line(page: str) -> str:
    """Return HTML without line breaks, because after a blank line the rest would be parsed as Markdown."""
    pieces = re2.split(r"(?s)(<pre\b.*?</pre>)", page.strip())
    return "".join(("&#10;" if i % 2 else " ").join(piece.splitlines()) for i, piece in enumerate(pieces))


@functools.lru_cache(maxsize=1024)
def clean(page: str) -> str:
    """Return HTML that contains only text, its structure, links and embedded pictures.

    A forbidden tag is shown as text. nh3 would remove it, and so change the meaning of "List<int>".
    """
    if _may_open(page) > _MOST_OPENED:
        return f"<pre>{escape(page)}</pre>"
    cleaned = _CLEANER.clean(_MARKUP.sub(_shown_or_kept, page).translate(_CONTROL))
    return cleaned if places_in_tables(cleaned) <= _MOST_PLACES else f"<pre>{escape(page)}</pre>"


def _may_open(page: str) -> int:
    """Return an upper limit for the number of elements that nh3 makes for formatting that is left open.

    At each tag, nh3 opens each kind of unclosed formatting again, up to three times per kind. So a text of 50,000
    characters can make it create gigabytes of elements, and it cannot be interrupted.
    """
    tags = list(_TAG.finditer(page))
    formatting = [tag[0] for tag in tags if tag[1].lower() in _FORMATTING]
    # A tag is read only up to its first quotation mark, so each tag that has one counts as a different kind.
    kinds = {tag for tag in formatting if tag[-1] not in "\"'"}
    return len(tags) * (3 * len(kinds) + sum(tag not in kinds for tag in formatting))


def _shown_or_kept(markup: Any) -> str:
    """Return an allowed tag or a comment unchanged, and anything else as text."""
    stays = markup[0] == "<!--" or (markup[1] or "").lower() in _TAGS
    return markup[0] if stays else markup[0].replace("<", "&lt;")


def _is_picture(address: str) -> bool:
    """Return True if an address itself contains a picture (data URL) that a page may show."""
    found = _PICTURE.fullmatch(address)
    return found is not None and is_shown(found[1])


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


class Renderer(IPythonRenderer):
    """nbconvert's renderer, but attached pictures are inserted last, because parsing a megabyte takes long."""

    def _embed_image_or_attachment(self, src: str) -> str:
        embedded: str = super()._embed_image_or_attachment("" if src.startswith(_ATTACHED) else src)
        return embedded or src


class _Looking(Renderer):
    """Renders as nbconvert does, and records everything that is more than plain Markdown."""

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
        """Record a diagram, which nbconvert writes into the page without escaping it."""
        self.is_plain = False
        return f"<pre>{escape(code)}</pre>"

    def link(self, text: str, url: str, title: str | None = None) -> str:
        if not _LINK.fullmatch(unescape(url)):
            self.is_plain = False
        return super().link(text, url, title)

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """Record a picture. One from another server would reveal who reads the page, and when."""
        if (name := url.removeprefix(_ATTACHED)) != url and name in self._left:
            self._left.remove(name)
            return super().image(text, url, title)
        if not _is_picture(url):
            self.is_plain = False
            return f"<em>[picture left out: {escape(text)}]</em>"
        return super().image(text, url, title)


def _as_shown(markdown: str) -> str:
    """Return the HTML that nbconvert will make of Markdown."""
    return MarkdownWithMath(renderer=IPythonRenderer(escape=False)).render(markdown)


def harmless_output(output: NotebookNode) -> NotebookNode:
    """Return the output of a student's cell, reduced to texts and bitmaps. The output is changed."""
    if "data" in output:
        output.data = {kind: _visible(output.data[kind]) for kind in SHOWN if kind in output.data}
        output.metadata = {}
    for words in ("text", "ename", "evalue", "traceback"):
        if words in output:
            output[words] = _visible(output[words])
    return output


def _visible(words: Any) -> Any:
    """Return the text (or lines) of an output, with characters that change the writing direction shown as escapes."""
    if isinstance(words, str):
        return visible(words)
    return [_visible(line) for line in words] if isinstance(words, list) else words
