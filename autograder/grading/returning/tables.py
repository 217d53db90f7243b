"""Computes the size of the tables on a page, as rows times columns.

The size has to be limited because a browser needs memory for each position in a table, even if the position has no
cell. A cell of twenty characters may span 1,000 columns, so 46 kB of text can make a table that no browser can open.
"""

from __future__ import annotations

from dataclasses import dataclass

import re2

# Matches the tags of tables as nh3 writes them: the values of attributes are in double quotes, and contain no double
# quotes.
_OF_TABLES = re2.compile(r"""<(/?table|tr|td|th)\b((?: [a-z]+="[^"]*")*)>""")
_SPAN = re2.compile(r' (colspan|rowspan)="([0-9]+)"')


def places_in_tables(page: str) -> int:
    """Return the sum, over all tables, of rows times columns, which is an upper limit of the real size.

    Args:
        page: HTML that nh3 has cleaned.
    """
    places = 0
    tables: list[_Table] = []
    for name, attributes in ((found[1], found[2]) for found in _OF_TABLES.finditer(page)):
        if name == "table":
            tables.append(_Table())
        elif name == "/table" and tables:
            places += tables.pop().places
        elif tables:
            spans = {span[1]: int(span[2]) for span in _SPAN.finditer(attributes)}
            tables[-1].add(name, spans.get("colspan", 1), spans.get("rowspan", 1))
    return places


@dataclass
class _Table:
    """The size of a table while its tags are read.

    Attributes:
        rows: The number of rows so far.
        width: The number of columns that the cells of the current row take.
        widest: The largest number of columns in any row.
        reaching: The number of columns of all cells that span into later rows, where they move other cells to the side.
    """

    rows: int = 0
    width: int = 0
    widest: int = 0
    reaching: int = 0

    def add(self, name: str, columns: int, rows: int) -> None:
        """Count a new row, or a cell."""
        if name == "tr":
            self.rows, self.width = self.rows + 1, 0
            return
        self.width += columns
        self.widest = max(self.widest, self.width)
        self.reaching += columns if rows != 1 else 0

    @property
    def places(self) -> int:
        """The number of rows times the largest possible number of columns."""
        return self.rows * (self.widest + self.reaching)
