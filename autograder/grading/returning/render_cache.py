"""Texts that take long to make and are needed again, as many as fit."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from collections.abc import Callable


class Remembered:
    """A cache of values by what they were made of; the longest unused is forgotten first.

    Args:
        characters: Of all texts together, at most.
    """

    def __init__(self, characters: int) -> None:
        self._left = characters
        self._texts: OrderedDict[bytes, str] = OrderedDict()

    def get(self, of: Any, make: Callable[[], str]) -> str:
        """The text that was made of exactly this, made now where it is not known.

        Args:
            of: All that the text depends on, as JSON has it.
            make: Makes the text.
        """
        # Students write a part of it: a hash for which nobody can find two values, and not the values themselves.
        key = hashlib.sha256(msgspec.json.encode(of)).digest()
        known = self._texts.get(key)
        if known is not None:
            self._texts.move_to_end(key)
            return known
        text = make()
        self._texts[key] = text
        self._left -= len(text)
        while self._left < 0:
            _, forgotten = self._texts.popitem(last=False)
            self._left += len(forgotten)
        return text
