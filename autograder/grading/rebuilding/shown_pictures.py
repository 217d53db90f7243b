"""Finds the pictures that the text cells of a rebuilt notebook show, of the student's and of the master's."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import re2
from nbformat import NotebookNode

from autograder.grading.rebuilding import nbformat_nodes

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


_MOST_CHARACTERS = 10_000_000
"""The maximum length of all bitmaps attached to a notebook, in base64 characters; a screenshot has about a million."""
_SHOWN = re2.compile(r"attachment:([\w.%+-]+)")


class ShownPictures:
    """Finds the pictures that text cells show: attached by the student, or otherwise from the master.

    Args:
        given: For each cell of the master, its text as students receive it, and its attachments. An attachment that
            none of these texts shows belongs to a solution, and is left out.
    """

    def __init__(self, given: Iterable[tuple[str, Mapping[str, Mapping[str, str]]]]) -> None:
        self._pictures: dict[str, Mapping[str, str]] = {}
        self._left: Counter[str] = Counter()
        self._characters = _MOST_CHARACTERS
        for text, attached in given:
            for name in attached.keys() & set(_SHOWN.findall(text)):
                self._pictures[name] = attached[name]
                self._left[name] += 1

    def of(self, text: str, own: Mapping[str, Mapping[str, str]]) -> NotebookNode:
        """Return the pictures that a text shows.

        A picture of the master is returned only as often as the master shows it, so that many copies of a cell do not
        make a page too large.

        Args:
            text: The text of a cell.
            own: The pictures that the student attached to the cell.
        """
        pictures: dict[str, Mapping[str, str]] = {}
        for name in dict.fromkeys(_SHOWN.findall(text)):
            size = sum(map(len, own.get(name, {}).values()))
            if 0 < size <= self._characters:
                self._characters -= size
                pictures[name] = own[name]
            elif self._left[name] > 0:
                self._left[name] -= 1
                pictures[name] = self._pictures[name]
        return nbformat_nodes.copied(NotebookNode(pictures))
