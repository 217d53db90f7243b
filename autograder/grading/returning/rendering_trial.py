"""The program of the desk that renders a notebook's texts as a trial, to find out how long that takes.

The module :mod:`autograder.grading.returning.rendering_time` starts the desk. The rendered texts are not used: the desk
only writes one byte after each text that it has rendered.
"""

from __future__ import annotations

import gc
import os
from typing import TYPE_CHECKING, Any

import msgspec
import pygments.lexers
from bs4 import BeautifulSoup
from nbconvert.filters.highlight import Highlight2HTML
from nbconvert.filters.markdown_mistune import markdown2html_mistune
from nbconvert.filters.strings import clean_html, strip_files_prefix

from autograder.execution.executed_cells import CellType
from autograder.grading.returning.sanitize import clean, harmless_markdown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Texts = list[tuple[CellType, str]]
"""The texts of the cells that a student wrote, each with the type of its cell."""

_SAMPLES = (
    "# A heading",
    "*a* **b** ~~c~~ `d` [e](f) ![g](h) <https://i>",
    "- a\n- b\n\n1. c\n\n> d\n\n---",
    "| a |\n| - |\n| b |",
    "$a$ and\n\n$$b$$",
    "<b>a</b>\n\n<div>b</div>",
    "```python\na\n```\n\n```no such language\nb\n```",
)
"""Texts that make nbconvert load everything that it would otherwise load when it is first needed. They are separate,
because ``harmless_markdown`` would leave one text with so much markup unrendered.
"""


def prepare() -> None:
    """Load everything that a desk needs, such as all of Pygments' lexers, because the desk itself cannot open files."""
    gc.disable()
    for name, *_ in pygments.lexers.get_all_lexers():
        pygments.lexers.find_lexer_class(name)
    for text in _SAMPLES:
        for kind in (CellType.MARKDOWN, CellType.CODE):
            render(kind, text)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Render the texts, and write one byte after each text.

    Args:
        call: Not used.
        descriptors: The texts as JSON, and an empty file for the answer.
    """
    del call
    source, answer = descriptors
    data = os.pread(source, os.lseek(source, 0, os.SEEK_END), 0)
    for kind, text in msgspec.json.decode(data, type=Texts):
        render(kind, text)
        os.write(answer, b".")


def render(kind: CellType, text: str) -> None:
    """Render one text of a cell in the same steps as a page does, without returning the result."""
    # The steps are those of the blocks "markdowncell" and "input" in nbconvert/templates/lab/base.html.j2.
    if kind is CellType.CODE:
        piece = clean_html(Highlight2HTML(pygments_lexer="ipython3")(text))
    elif kind is CellType.MARKDOWN:
        piece = strip_files_prefix(clean(markdown2html_mistune(harmless_markdown(text))))
    else:
        return  # pages show a cell of any other type as typed
    BeautifulSoup(piece, "html.parser")  # nbconvert's HTMLExporter parses the page, too
