"""Counts, and the difference of two texts, in the words of a sentence for a student."""

from __future__ import annotations

SHOWN = 16
"""Characters that are quoted behind the place where two texts differ."""


def counted(number: int, thing: str) -> str:
    """``"1 message"``, ``"2 messages"``."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def first_difference(said: str, wanted: str) -> str:
    """The place where a text stops being the one that was asked for, in a sentence; empty where they are the same."""
    if said == wanted:
        return ""
    same = said[
        : next((n for n, (a, b) in enumerate(zip(said, wanted, strict=False)) if a != b), len(wanted))
    ]
    place = f"After “{same[-SHOWN:]}”" if same else "At the beginning"
    return f"{place} the task has {_next(wanted, same)}, and yours has {_next(said, same)}."


def _next(text: str, same: str) -> str:
    rest = text[len(same) :]
    return f"“{rest[:SHOWN]}”" if rest else "nothing more"
