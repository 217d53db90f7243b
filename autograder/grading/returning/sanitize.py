"""Makes a submission's texts and outputs harmless, for a browser and for the programs that make pages of them.

nbconvert and formgrader render Markdown and highlight code. Their parsers copy raw HTML, Mermaid diagrams and any
address into a page, and a student can write a text that keeps them busy for minutes. So no parser reads what a student
wrote: a page shows the characters as they were typed, with pasted pictures at their places. Only the course's own text,
even if it comes from the submission, is rendered.
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import re2

from autograder.execution.executed_cells import IMAGES, CellType
from autograder.grading.rebuilding.notebook_rebuilding import is_check, is_the_masters
from autograder.grading.returning.picture_sizes import PixelBudget

if TYPE_CHECKING:
    from collections.abc import Collection

    from nbformat import NotebookNode

SHOWN = (*IMAGES, "text/plain")
"""The media types that an output of a student's cell may have, because they cannot contain scripts."""
TYPED = '<pre style="white-space: pre-wrap; word-break: normal; overflow-wrap: anywhere">\n'
"""The beginning of a text cell that is shown as typed. Every Markdown renderer copies such a cell into the page."""
_LEFT_OUT = "[picture left out: it is too large, or damaged]"
_ADDRESS = r"attachment:(?P<{0}name>[\w.%+-]+)|(?P<{0}data>data:image/(?:png|jpeg);base64,[A-Za-z0-9+/=]+)"
# Matches a whole picture in Markdown; in HTML, it matches only the address in `src`.
_PICTURE = re2.compile(rf"!\[(?P<alt>[^\[\]\n]*)\]\((?:{_ADDRESS.format('')})\)|{_ADDRESS.format('bare_')}")
_ESCAPES = {
    code: f"\\u{code:04x}"
    for code in (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))
} | {code: f"\\x{code:02x}" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\t\n\r"}
"""The characters that change the writing direction, and control characters, each with the escape to show instead.

The first are replaced because with them, a text may look different from its real content (Unicode TR 36, "Bidirectional
Text"); the others because they control the program that shows the page.
"""
_LONGEST_CODE = 40
"""The maximum length of a code for a terminal; those of a color have up to twenty characters."""


def escape_marks(text: str) -> str:
    """Return ``text`` with escapes for control characters, and for those that change the writing direction."""
    return text if text.isprintable() else text.translate(_ESCAPES)


def make_harmless(notebook: NotebookNode, own: Collection[int] = ()) -> NotebookNode:
    """Remove everything from a student's texts and outputs that a browser could execute or load, or that misleads.

    The text of the master's cells and the outputs of its check cells, which show verdicts, stay unchanged; but pictures
    that are too large are removed everywhere. Outputs and code of a notebook may be made harmless twice.

    Args:
        notebook: A rebuilt or graded notebook. It is changed.
        own: The indexes of the cells with a student's text. In a graded notebook, these texts are harmless already.

    Returns:
        The same notebook.
    """
    pictures = PixelBudget()
    for index, cell in enumerate(notebook.cells):
        if not is_the_masters(cell):
            _make_text_harmless(cell, pictures, is_own=index in own)
        if cell.cell_type == CellType.CODE:
            shows_verdict = is_check(cell) and is_the_masters(cell)
            outputs = cell.outputs if shows_verdict else map(harmless_output, cell.outputs)
            cell.outputs = [_with_pictures_that_fit(output, pictures) for output in outputs]
    return notebook


def _make_text_harmless(cell: NotebookNode, pictures: PixelBudget, *, is_own: bool) -> None:
    if cell.cell_type == CellType.CODE:
        cell.source = escape_marks(cell.source)
        cell.metadata["magics_language"] = "text"  # so that nbconvert shows the code without highlighting
        return
    attached = {
        name: {kind: data}
        for name, kinds in cell.pop("attachments", {}).items()
        for kind, data in kinds.items()
        if kind in IMAGES and pictures.fit(data)
    }
    if is_own:
        cell.update(cell_type=CellType.MARKDOWN, source=as_typed(cell.source, attached, pictures))
    if attached:
        cell["attachments"] = attached


def as_typed(source: str, attached: Collection[str], pictures: PixelBudget) -> str:
    """Return HTML, also valid as Markdown, that shows a text cell as it was typed, with its pictures at their places.

    Args:
        source: The text of the cell.
        attached: The names of the pictures attached to the cell, each of which is shown once.
        pictures: Counts the pictures that are part of the text.
    """
    left, pieces, end = set(attached), [], 0
    for found in _PICTURE.finditer(source):
        name, data = found["name"] or found["bare_name"], found["data"] or found["bare_data"]
        piece = _escaped(found[0])
        if name in left:
            left.remove(name)
            piece = _picture(found["alt"], f"attachment:{name}")
        elif data:
            fits = pictures.fit(data.partition(",")[2])
            piece = _picture(found["alt"], data) if fits else _escaped(_LEFT_OUT)
        pieces += [_escaped(source[end : found.start()]), piece]
        end = found.end()
    return f"{TYPED}{''.join(pieces)}{_escaped(source[end:])}</pre>"


def _picture(alternative: str | None, address: str) -> str:
    return f'<img alt="{_escaped(alternative or "picture")}" src="{address}">'


def _escaped(text: str) -> str:
    """Return text as HTML. ``[`` is escaped too: nbconvert looks for links of Markdown in a page, in quadratic time."""
    return escape(escape_marks(text)).replace("[", "&#91;")


def _with_pictures_that_fit(output: NotebookNode, pictures: PixelBudget) -> NotebookNode:
    """Return an output in which a sentence replaces each picture that is invalid or too large."""
    for kind in IMAGES:
        encoded = output.get("data", {}).get(kind)
        if encoded is not None and not pictures.fit("".join(encoded)):
            del output.data[kind]
            output.data["text/plain"] = _LEFT_OUT
    return output


def harmless_output(output: NotebookNode) -> NotebookNode:
    """Return an output of a student's cell with everything but texts and bitmaps removed."""
    if "data" in output:
        output.data = {kind: _escape_marks_in(output.data[kind]) for kind in SHOWN if kind in output.data}
        output.metadata = {}
    for words in ("text", "ename", "evalue", "traceback"):
        if words in output:
            output[words] = _escape_marks_in(_without_machine(output[words]))
    return output


_ON_THIS_MACHINE = re2.compile(r"(?:/[\w.+@-]+)+/((?:site-packages|python3\.\d+)/)")


def _without_machine(words: Any) -> Any:
    """Return a text, or a list of lines, without the grader's folders in paths of Python's library."""
    if isinstance(words, str):
        return _ON_THIS_MACHINE.sub(r"…/\1", words)
    return [_without_machine(line) for line in words] if isinstance(words, list) else words


def _escape_marks_in(words: Any) -> Any:
    """Return a text, or a list of lines, with the escapes of :func:`escape_marks`, but with its colors."""
    if isinstance(words, str):
        first, *others = map(escape_marks, words.split("\x1b"))
        return first + "".join(("\x1b" if _is_code(other) else "\\x1b") + other for other in others)
    return [_escape_marks_in(line) for line in words] if isinstance(words, list) else words


def _is_code(text: str) -> bool:
    """Return True if a text that follows an escape character begins with the rest of a code for a terminal.

    nbconvert shows colors, and drops other codes.
    """
    end = text[1:_LONGEST_CODE].lstrip("0123456789;:?")[:1]
    return text.startswith("[") and "@" <= end <= "~"
