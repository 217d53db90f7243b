"""Tests with inputs that hypothesis draws: the same in each run, so that no verdict depends on chance.

A case that was once found stays as ``@example`` at its test.
"""

from __future__ import annotations

from hypothesis import settings


def drawn(examples: int) -> settings:
    """Return the settings of a test with so many inputs, which should take at most three seconds."""
    return settings(max_examples=examples, derandomize=True, deadline=None, database=None)
