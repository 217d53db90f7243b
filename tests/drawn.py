"""Tests with inputs that hypothesis draws: the same in each run, so that no verdict depends on chance.

A case that was once found stays as ``@example`` at its test.
"""

from __future__ import annotations

from hypothesis import HealthCheck, settings


def drawn(examples: int) -> settings:
    """Return the settings of a test with so many inputs, which should take at most three seconds."""
    # Neither a deadline nor a check of hypothesis's own may fail because the machine is busy.
    slow = [HealthCheck.too_slow]
    return settings(
        max_examples=examples, derandomize=True, deadline=None, database=None, suppress_health_check=slow
    )
