"""From measurements to figures with their aims."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING

from benchmarks.results import Figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.machine import Usage
    from benchmarks.ours import OurRun
    from benchmarks.stock import StockRun

THROUGHPUT, BUSY = 30.0, 0.85


def load_of(usage: Usage) -> str:
    """The machine while something was measured, in words."""
    others = "" if usage.others is None else f", others took {usage.others:.0%}"
    return f"load {usage.load:.1f}{others}"


def throughput(stock: Sequence[StockRun], ours: OurRun, students: int) -> Figure:
    """Our pace against stock nbgrader's."""
    slow = statistics.fmean(run.for_class(students) for run in stock)
    fast = ours.usage.seconds
    ratio = slow / fast
    sampled = sum(len(run.students) for run in stock)
    return Figure(
        f"class of {students} students, {ours.notebooks} notebooks, boxes on, against `nbgrader autograde`",
        f"{THROUGHPUT:g} times",
        f"{ratio:.1f} times: {fast:.0f} s ({fast / ours.notebooks:.2f} s a notebook, feedback included) against "
        f"{slow:.0f} s ({statistics.fmean(run.per_notebook for run in stock):.1f} s a notebook, without feedback; "
        f"extrapolated per student from {sampled})",
        ratio >= THROUGHPUT,
        f"{load_of(ours.usage)}; stock: {load_of(stock[0].usage)}",
    )


def busy(ours: OurRun) -> Figure:
    """How busy the cores were."""
    return Figure(
        "cores busy from the first to the last notebook",
        f"at least {BUSY:.0%}",
        f"{ours.busy_working:.0%}",
        ours.busy_working >= BUSY,
        load_of(ours.usage),
    )


def points(differences: Sequence[str], honest: int) -> Figure:
    """Points in both gradebooks."""
    return Figure(
        "points for honest submissions, here and in stock nbgrader",
        "identical",
        f"{honest - len(differences)} of {honest} notebooks identical",
        not differences,
        "–",
    )
