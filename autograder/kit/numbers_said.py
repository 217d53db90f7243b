"""Whether somebody said a number."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Sequence


_UNSIGNED = r"(?:^|[^\d\-−]|[\d\-−][\-−])"
"""What stands before a number without a sign. A dash behind a digit, or one of a row of dashes, is no sign."""


def mentions(lines: Sequence[str], number: int) -> bool:
    """Whether the number stands in one of the lines, with or without separators between its digits."""
    digits = r"[,_' .]?".join(str(abs(number)))
    before, after = _UNSIGNED, r"(?:\D|$)"
    if number < 0:
        before = r"(?:^|\D)[-−]\s?"
    elif number == 0:
        # The 0 of 0.5 and of 1.0 is none; one at the end of a row of dots is.
        before, after = r"(?:^|[^\d.\-−]|[\d\-−][\-−]|(?:^|\D)\.)", r"(?:[^\d.,]|[.,]\D|[.,]?$)"
    return any(re2.search(f"{before}{digits}{after}", line) for line in lines)
