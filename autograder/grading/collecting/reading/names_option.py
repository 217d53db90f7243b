"""The option ``--names``, an instructor's pattern for names: ``--names '{id}-{last}_{assignment}'``."""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.grading.collecting.reading.lms_file_names import Found, base_of, read_time
from autograder.grading.errors import GradingError
from autograder.grading.table.roster import Identity

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

WORDS = ("id", "email", "login", "number", "name", "first", "last", "assignment", "time", "file", "any")
_NOT_WHO = {"any", "assignment", "time", "file"}
_MOST_WAYS = 100
"""The maximum number of ways to divide a name that are tried; real names need a few."""
_WORD = re2.compile(r"\{([^{}]*)\}")


def check_names(pattern: str, columns: Collection[str]) -> None:
    """Check a pattern given with ``--names``.

    Args:
        pattern: The pattern to check.
        columns: The columns of ``students.csv`` that the pattern may contain.

    Raises:
        GradingError: The pattern contains an unknown word, a word twice, or no word that identifies a student.
    """
    words = [word for word in _WORD.findall(pattern) if word != "any"]
    says_who = set(words) & {*WORDS[:7], *columns}
    if set(words) - {*WORDS, *columns} or len(set(words)) < len(words) or not says_who:
        known = ", ".join(f"{{{word}}}" for word in (*WORDS, *columns))
        raise GradingError(
            f"--names {pattern!r} cannot be used. Use each of {known} at most once, and at least one that "
            "identifies the student. For example: '{id}-{last}_{assignment}'."
        )


def read_names(pattern: str) -> Callable[[Sequence[str], int], Found | None]:
    """Return a function that reads a path according to a pattern.

    The pattern has to fit from the top of the path, or to identify the student by one of the path's first ``levels``
    names, because a student may have chosen any name below these.

    A pattern without a slash describes a single name: a file without its suffix, or a folder around it. A pattern
    with slashes describes names that follow each other in a path. ``{any}`` stands for any text. A word that is not
    in :data:`WORDS` stands for a column of ``students.csv``.
    """
    words = _WORD.findall(pattern)
    literals = [unicodedata.normalize("NFC", one).casefold() for one in _WORD.split(pattern)[::2]]
    number = pattern.count("/") + 1
    says_who = (place for place, name in enumerate(pattern.split("/")) if set(_WORD.findall(name)) - _NOT_WHO)
    who = next(says_who, 0)

    def read(parts: Sequence[str], levels: int) -> Found | None:
        for place in range(min(len(parts) - number + 1, max(levels - who, 1))):
            *above, last = parts[place : place + number]
            bare = last.rpartition(".")[0] if place + number == len(parts) else ""
            texts = ("/".join([*above, name]) for name in (bare, last) if name)
            ways = (list(itertools.islice(_ways(text, literals, words), _MOST_WAYS)) for text in texts)
            if divided := next(filter(None, ways), None):
                # Use the longest possible time, because in 2025-10-03_140506_lab the day alone would be a time, too.
                divided.sort(
                    key=lambda way: -len(way.get("time", "")) if read_time(way.get("time", "")) else 0
                )
                # Return all ways to divide the name, because ben_b_7 may belong to ben or to ben_b.
                found = [_found(way, parts[-1]) for way in divided]
                return replace(found[0], readings=tuple(dict.fromkeys(one.identity for one in found)))
        return None

    return read


def _ways(text: str, literals: Sequence[str], words: Sequence[str]) -> Iterator[dict[str, str]]:
    """Yield all ways to divide a text into the words between these literals."""
    folded, first = text.casefold(), literals[0]
    if len(folded) != len(text) or not folded.startswith(first):
        return
    text, folded = text[len(first) :], folded[len(first) :]
    if not words:
        if not text:
            yield {}
        return
    for end in range(words[0] != "any", len(text) + 1):
        if "/" in text[:end]:
            return
        if folded.startswith(literals[1], end):
            for way in _ways(text[end:], literals[1:], words[1:]):
                yield {words[0]: text[:end], **way}


def _found(said: dict[str, str], file: str) -> Found:
    word = {name: value.strip() for name, value in said.items()}
    login = word.get("id") or word.get("email") or word.get("login") or word.get("number") or ""
    name = word.get("name") or f"{word.get('first', '')} {word.get('last', '')}".strip()
    column = next((one for one in word if one not in WORDS), "")
    number = word.get(column, "")
    identity = Identity(column, number, login, name)
    return Found(
        identity,
        word.get("file") or file,
        when=read_time(word.get("time", "")),
        assignment=base_of(word.get("assignment", "")),
    )
