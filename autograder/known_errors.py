"""Looks up what Python, rclpy, colcon or a shell says in the table of known errors, ``known_errors.toml``.

The judge shows what a row says on a card, and a notebook shows it below a cell that raised an exception.
"""

from __future__ import annotations

import functools
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import re2

if TYPE_CHECKING:
    from collections.abc import Iterable


class KnownError(msgspec.Struct, frozen=True):
    """A row of the table; the head of ``known_errors.toml`` explains its columns.

    The texts of a row from :func:`rows` are templates. The texts of a row from :func:`recognized` are filled in.
    """

    key: str
    heard: tuple[str, ...]
    says: str | list[str]
    means: str
    do: str
    source: str | list[str]
    each: str = ""
    uses: tuple[str, ...] = ()


class _Table(msgspec.Struct, frozen=True):
    parts: dict[str, str]
    each: dict[str, dict[str, str]]
    error: list[KnownError]


class Name(str):
    """A name for a template. In ``{owner:your future}``, the text after the colon is used if the name is empty."""

    __slots__ = ()

    def __format__(self, otherwise: str) -> str:
        return str(self) or otherwise


_RESULT = ".result()"


def rows() -> list[KnownError]:
    """Return all rows, in the order in which they are tried."""
    return _table().error


def recognized(said: str, heard: str, here: str = "", owner: str = "") -> KnownError | None:
    """Return the first row that matches, with its texts filled in; None if no row matches.

    Args:
        said: A traceback, or lines of output.
        heard: The origin of the text: one of the words that the column ``heard`` of the table uses.
        here: The packages with this course's interfaces, as :func:`packages` returns them.
        owner: What is before the dot of a missing attribute, such as ``fut.result()``; empty if unknown.
    """
    for row, pattern in _patterns(heard):
        match = pattern.search(said)
        if match is None:
            continue
        groups = {name: text or "" for name, text in match.groupdict().items()}
        meant = _table().each.get(row.each, {})
        word = next((meant[text] for text in groups.values() if text in meant), "")
        future = owner.removesuffix(_RESULT) if owner.endswith(_RESULT) else ""
        words = {
            "here": here,
            "owner": owner,
            "future": "" if "(" in future else future,
            "each": word,
        } | groups
        names = {name: Name(text.strip()) for name, text in words.items()}
        # A group that did not take part in the match leaves a blank at an end: there is no name then.
        uses = tuple(name for pattern in row.uses if (name := pattern.format(**names)) == name.strip())
        means, do = row.means.format(**names).strip(), row.do.format(**names)
        return msgspec.structs.replace(row, means=means, do=do, uses=uses)
    return None


def packages(names: Iterable[str]) -> str:
    """Return the names of the packages with this course's interfaces, joined with "or" for use in a sentence."""
    return " or ".join(sorted(set(names))) or "the package that the lab imports from"


def pattern_of(row: KnownError) -> Any:
    """Return the compiled pattern of a row of ``known_errors.toml``."""
    table = _table()
    parts = table.parts | {"each": "|".join(table.each.get(row.each, ()))}
    pattern = row.says if isinstance(row.says, str) else "|".join(row.says)
    for name, part in parts.items():
        pattern = pattern.replace(f"%{name}%", part)
    return re2.compile(f"(?m){pattern}")


@functools.cache
def _table() -> _Table:
    text = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
    return msgspec.convert(tomllib.loads(text), type=_Table)


@functools.cache
def _patterns(heard: str) -> list[tuple[KnownError, Any]]:
    return [(row, pattern_of(row)) for row in rows() if heard in row.heard]


if __name__ == "__main__":  # a shell that does not find a command of a cell asks what this means
    for _row in filter(None, [recognized(f"{sys.argv[1]}: command not found", "bash")]):
        print(_row.means, _row.do, file=sys.stderr)
