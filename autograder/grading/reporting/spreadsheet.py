"""CSV files that a spreadsheet shows and never executes."""

from __future__ import annotations

import csv
import io
import unicodedata
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable

_FORMULA = frozenset("=+-@\N{MINUS SIGN}")
# Where a spreadsheet may be set to split a line; behind it, a formula could begin.
_BEHIND_A_SEPARATOR = re2.compile(r"([;|]\s*)([=+@-])")
_SPACES = frozenset({"Cc", "Zl", "Zp", "Zs"})


def csv_text(rows: Iterable[Iterable[str | float]]) -> str:
    """Rows as the text of a CSV file. Texts are defused; numbers stay numbers."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([defused(cell) if isinstance(cell, str) else f"{cell:g}" for cell in row])
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

    Where one would begin, an apostrophe is put in front, which spreadsheets read as "this is text". Full-width
    signs count: some programs fold them. Tabs, line breaks and other control characters become blanks, and what
    is not seen (such as a change of the writing direction) is left out.

    Args:
        cell: Any text.
    """
    kinds = ((character, unicodedata.category(character)) for character in cell)
    cell = "".join(" " if kind in _SPACES else character for character, kind in kinds if kind != "Cf")
    folded = unicodedata.normalize("NFKC", cell).lstrip()
    if folded[:1] in _FORMULA and folded:
        cell = f"'{cell}"
    return _BEHIND_A_SEPARATOR.sub(r"\1'\2", cell)
