"""Numbers in what somebody said."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Sequence


_DASH = r"[\d\-−][\-−]"
"""A dash that is no sign: behind a digit, or one of a row of dashes."""
_UNSIGNED = rf"(?:^|[^\d\-−]|{_DASH})"
"""The characters before a number without a sign."""
_UNSIGNED_ZERO = rf"(?:^|[^\d.\-−]|{_DASH}|(?:^|\D)\.)"
"""The same before a 0: that of 0.5 and of 1.0 is none, one at the end of a row of dots is."""


def mentions(lines: Sequence[str], number: int) -> bool:
    """True if the number is in one of the lines, with or without separators between its digits."""
    digits = r"[,_' .]?".join(str(abs(number)))
    before, after = _UNSIGNED, r"(?:\D|$)"
    if number < 0:
        before = r"(?:^|\D)[-−]\s?"
    elif number == 0:
        before, after = _UNSIGNED_ZERO, r"(?:[^\d.,]|[.,]\D|[.,]?$)"
    return any(re2.search(f"{before}{digits}{after}", line) for line in lines)
