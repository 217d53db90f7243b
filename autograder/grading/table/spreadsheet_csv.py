"""Reads CSV text, and writes CSV text in which a spreadsheet executes no text of a student as a formula."""

from __future__ import annotations

import csv
import functools
import io
import unicodedata
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable


# A list from an LMS may contain students' texts of any length, so raise Python's limit for a cell.
csv.field_size_limit(2**31 - 1)
_FORMULA = frozenset("=+-@\N{MINUS SIGN}")
# A spreadsheet program with the settings of another country may begin a new cell at any of these characters, and a
# formula could begin there. A quotation mark after one of them begins a quoted cell, so it is dangerous, too.
_SEPARATOR = re2.compile(r"([,;|])")
_SPACES = frozenset({"Cc", "Zl", "Zp", "Zs"})


def csv_text(rows: Iterable[Iterable[str | float]], delimiter: str = ",", line_end: str = "\n") -> str:
    """Return rows as CSV text. Texts that look like formulas are changed by :func:`defused`."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=delimiter, lineterminator=line_end)
    # Cache the results, because most texts appear many times in the rows of a class.
    as_text = functools.cache(defused)
    for row in rows:
        writer.writerow([as_text(cell) if isinstance(cell, str) else f"{cell:g}" for cell in row])
    return text.getvalue()


def blank(score: float | None) -> float | str:
    """Return points as the content of a cell; None becomes an empty cell."""
    return "" if score is None else score


def csv_rows(data: bytes) -> tuple[list[list[str]], str]:
    """Return the rows of a CSV file from an LMS or a spreadsheet, and the character that separates its cells.

    The separator may be a comma, a semicolon or a tab. The encoding may be UTF-8, UTF-16 or, from Excel, Windows-1252.
    Call :func:`original` to get the text of a cell.
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
    """Return the text of a cell, without an apostrophe that :func:`defused` has put in front of it."""
    return cell[1:] if cell[:1] == "'" and cell[1:2] in _FORMULA else cell


def defused(cell: str) -> str:
    """Return a text that no spreadsheet executes as a formula (OWASP, "CSV Injection").

    An apostrophe is put in front of a possible formula, so that spreadsheets read the cell as text. A formula may be at
    the beginning of the text, or after a character at which some spreadsheets split a line. Full-width signs such as
    "＝" count as well, because some programs convert them to "=". Control characters such as tabs become spaces, and
    invisible characters are removed.

    Args:
        cell: The original text.
    """
    kinds = ((character, unicodedata.category(character)) for character in cell)
    cell = "".join(" " if kind in _SPACES else character for character, kind in kinds if kind != "Cf")
    return "".join(
        f"'{part}" if _begins_formula(part, ' "' if place else " ") else part
        for place, part in enumerate(_SEPARATOR.split(cell))
    )


def _begins_formula(text: str, before: str) -> bool:
    return unicodedata.normalize("NFKC", text).lstrip(before)[:1] in _FORMULA
