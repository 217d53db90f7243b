"""Lines of files that are not Python: launch files in XML and YAML, interfaces, ``package.xml``, ``CMakeLists.txt``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import Edit

if TYPE_CHECKING:
    from collections.abc import Iterator

_WORD = re.compile(r"[\w/.]{4,}")


def line_dropped(text: str) -> Iterator[Edit]:
    """A line that is not there."""
    for start, end in _lines(text):
        yield Edit(start, end, "")


def line_doubled(text: str) -> Iterator[Edit]:
    """A line that stands twice."""
    for start, end in _lines(text):
        yield Edit(start, end, text[start:end] * 2)


def word_misspelt(text: str) -> Iterator[Edit]:
    """A word without its last letter."""
    for start, end in _lines(text):
        for word in _WORD.finditer(text, start, end):
            yield Edit(word.end() - 1, word.end(), "")


def _lines(text: str) -> Iterator[tuple[int, int]]:
    """Where lines begin and end that are more than comments or brackets."""
    start = 0
    for line in text.splitlines(keepends=True):
        end = start + len(line)
        bare = line.strip()
        if _WORD.search(bare) and not bare.startswith(("#", "<!--", "===", "<?xml")) and start:
            yield start, end
        start = end


LINES = (line_dropped, line_doubled, word_misspelt)
