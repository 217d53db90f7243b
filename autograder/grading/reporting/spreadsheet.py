"""CSV files that a spreadsheet shows and never executes."""

from __future__ import annotations

import csv
import functools
import io
import unicodedata
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable

# A list of an LMS's has in it what students have typed there, which may be long.
csv.field_size_limit(50_000_000)
_FORMULA = frozenset("=+-@\N{MINUS SIGN}")
# Where a spreadsheet may be set to split a line; behind it, a formula could begin.
_SEPARATOR = re2.compile(r"([;|])")
_SPACES = frozenset({"Cc", "Zl", "Zp", "Zs"})


def csv_text(rows: Iterable[Iterable[str | float]]) -> str:
    """Rows as the text of a CSV file. Texts are defused; numbers stay numbers."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    as_text = functools.cache(defused)  # in the rows of a class most texts stand again and again
    for row in rows:
        writer.writerow([as_text(cell) if isinstance(cell, str) else f"{cell:g}" for cell in row])
    return text.getvalue()


def blank(score: float | None) -> float | str:
    """Points as a cell: empty where there are none, which is not zero."""
    return "" if score is None else score


def csv_rows(text: str) -> list[list[str]]:
    """The rows of a CSV file, as it is said or with semicolons; what was defused is as it was before."""
    first = text.partition("\n")[0]
    rows = csv.reader(io.StringIO(text), delimiter=";" if first.count(";") > first.count(",") else ",")
    return [[original(cell) for cell in row] for row in rows]


def original(cell: str) -> str:
    """A cell as it was before :func:`defused` put an apostrophe in front."""
    return cell[1:] if cell[:1] == "'" and cell[1:2] in _FORMULA and cell[1:] else cell


def defused(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula (OWASP, "CSV Injection").

    Where one would begin, at the start or where some split a line, an apostrophe is put in front, and spreadsheets read
    that as "this is text". Full-width signs count: some programs fold them. Tabs, line breaks and other control
    characters become blanks, and what is not seen (such as a change of the writing direction) is left out.

    Args:
        cell: Any text.
    """
    kinds = ((character, unicodedata.category(character)) for character in cell)
    cell = "".join(" " if kind in _SPACES else character for character, kind in kinds if kind != "Cf")
    return "".join(f"'{part}" if _is_formula(part) else part for part in _SEPARATOR.split(cell))


def _is_formula(text: str) -> bool:
    folded = unicodedata.normalize("NFKC", text).lstrip()
    return folded[:1] in _FORMULA and folded != ""
