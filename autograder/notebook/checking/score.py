"""The value of a check cell: the points, as nbgrader reads them, and nothing more to look at."""

from __future__ import annotations


class Score(float):
    """Points. In a notebook the card has said them, so that no bare number is shown below it.

    Stock nbgrader takes the points from the plain text of the cell's value, which is the number.
    """

    def _repr_html_(self) -> str:
        return '<span class="agc-cell-value" hidden="hidden"></span>'
