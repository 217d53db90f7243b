"""What counts as the memory of boxes."""

from __future__ import annotations

from benchmarks.memory import own_memory

WAITS = [("bwrap", 160_000), ("cat", 120_000)]


def test_a_box_counts_only_while_a_program_runs_in_it() -> None:
    assert own_memory([WAITS, [*WAITS, ("python", 26_000_000)], [("python", 9_000_000)]]) == (
        26_280_000,
        9_000_000,
    )
