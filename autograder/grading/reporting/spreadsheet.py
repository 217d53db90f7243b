"""CSV files that a spreadsheet shows without executing formulas in them."""

from __future__ import annotations

import csv
import functools
import io
import unicodedata
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable

# A list from an LMS contains texts that students have typed. They may be of any length, so a cell has no limit of its
# own.
csv.field_size_limit(2**31 - 1)
_FORMULA = frozenset("=+-@\N{MINUS SIGN}")
# A spreadsheet may be set to split a line at these characters, so a formula could begin after them.
_SEPARATOR = re2.compile(r"([;|])")
_SPACES = frozenset({"Cc", "Zl", "Zp", "Zs"})


def csv_text(rows: Iterable[Iterable[str | float]]) -> str:
    """Return rows as CSV text. Texts are made harmless; numbers stay numbers."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    # Cache the texts, because most of them appear many times in the rows of a class.
    as_text = functools.cache(defused)
    for row in rows:
        writer.writerow([as_text(cell) if isinstance(cell, str) else f"{cell:g}" for cell in row])
    return text.getvalue()


def blank(score: float | None) -> float | str:
    """Return points as a cell: empty if there are none, which differs from zero."""
    return "" if score is None else score


def csv_rows(data: bytes) -> tuple[list[list[str]], str]:
    """Return the rows of a table that a system or a spreadsheet saved, and the separator of its cells.

    Commas, semicolons and tabs separate cells; the text is in UTF-8, in UTF-16 or, from Excel, in the encoding of
    Western European systems. The cells are as they stand there; :func:`original` is their text.
    """
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = data.decode("utf-16", "replace")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("cp1252", "replace")
    first = text.partition("\n")[0]
    separator = max(",;\t", key=first.count)
    return list(csv.reader(io.StringIO(text, newline=""), delimiter=separator)), separator


def original(cell: str) -> str:
    """Return a cell without the apostrophe that :func:`defused` put in front."""
    return cell[1:] if cell[:1] == "'" and cell[1:2] in _FORMULA and cell[1:] else cell


def defused(cell: str) -> str:
    """Return the text of a cell, changed so that no spreadsheet takes it for a formula (OWASP, "CSV Injection").

    An apostrophe is put before a possible formula: at the start, or after a character at which some spreadsheets
    split. Spreadsheets then read the cell as text. Full-width signs count as well, because some programs convert
    them. Tabs, line breaks and other control characters become spaces, and invisible characters (such as changes of
    the writing direction) are removed.

    Args:
        cell: Any text.
    """
    kinds = ((character, unicodedata.category(character)) for character in cell)
    cell = "".join(" " if kind in _SPACES else character for character, kind in kinds if kind != "Cf")
    return "".join(f"'{part}" if _is_formula(part) else part for part in _SEPARATOR.split(cell))


def _is_formula(text: str) -> bool:
    folded = unicodedata.normalize("NFKC", text).lstrip()
    return folded[:1] in _FORMULA and folded != ""
