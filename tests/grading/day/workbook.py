"""What stands in the cells of a workbook: read with nothing that has written it."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING
from xml.etree import ElementTree

if TYPE_CHECKING:
    from pathlib import Path

_S = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


def rows_of(path: Path, sheet: int) -> list[dict[str, str | float]]:
    """The rows of a sheet below its first one, which has the columns' names.

    Args:
        path: A ``.xlsx``.
        sheet: Counted from 1.
    """
    with zipfile.ZipFile(path) as book:
        texts = [
            "".join(part.text or "" for part in one.iter(f"{_S}t"))
            for one in ElementTree.fromstring(book.read("xl/sharedStrings.xml")).iter(f"{_S}si")
        ]
        tree = ElementTree.fromstring(book.read(f"xl/worksheets/sheet{sheet}.xml"))
    # A cell without a value may be left out, so each says its column, as C7 does.
    names, *rows = (
        {cell.attrib["r"].rstrip("0123456789"): _value(cell, texts) for cell in row.iter(f"{_S}c")}
        for row in tree.iter(f"{_S}row")
    )
    assert all(row.keys() <= names.keys() for row in rows)
    return [{str(name): row.get(column, "") for column, name in names.items()} for row in rows]


def _value(cell: ElementTree.Element, texts: list[str]) -> str | float:
    assert cell.find(f"{_S}f") is None, "no cell has a formula"
    value = cell.findtext(f"{_S}v")
    if value is None:
        return ""
    return texts[int(value)] if cell.get("t") == "s" else float(value)
