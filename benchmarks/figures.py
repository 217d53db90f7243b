"""From measurements to figures with their aims."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING

from benchmarks.results import Figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.box_start import BoxStart
    from benchmarks.execution import ExecuteRun
    from benchmarks.floor import Floor
    from benchmarks.machine import Usage
    from benchmarks.ours import OurRun
    from benchmarks.stock import StockRun

MB = 1e6
THROUGHPUT, BUSY, BOX_MB, BOX_MS = 30.0, 0.85, 150.0, 150.0
CHECK_MEDIAN, CHECK_P95, REGRADE, EXECUTE_BEYOND, INTERRUPT = 0.5, 1.0, 2.0, 5.0, 3.0


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


def memory(ours: OurRun) -> list[Figure]:
    """Memory of the grader over time, and of a box."""
    load = load_of(ours.usage)
    if len(ours.memory) < 4:
        return []
    quarter = max(1, len(ours.memory) // 4)
    early = statistics.median(sample.grader for sample in ours.memory[quarter : 2 * quarter]) / MB
    late = statistics.median(sample.grader for sample in ours.memory[-quarter:]) / MB
    boxes = [size / MB for sample in ours.memory for size in sample.boxes]
    figures = [
        Figure(
            "memory of the grader's process, second quarter of the run and last quarter",
            "flat",
            f"{early:.0f} MB and {late:.0f} MB; all processes together at most "
            f"{max(sample.together for sample in ours.memory) / MB:.0f} MB",
            late <= 1.1 * early,
            load,
        )
    ]
    if boxes:
        figures.append(
            Figure(
                "a box's own memory (PSS)",
                f"under {BOX_MB:g} MB",
                f"median {statistics.median(boxes):.0f} MB, 95th percentile {_percentile(boxes, 0.95):.0f} MB, "
                f"at most {max(boxes):.0f} MB",
                _percentile(boxes, 0.95) < BOX_MB,
                load,
            )
        )
    return figures


def checks(floor: Sequence[Floor], load: str) -> list[Figure]:
    """Time of a check cell in an open notebook; those that build a workspace take what colcon takes."""
    spent = [check for one in floor for check in one.checks]
    watching = [seconds for seconds, built in spent if not built]
    building = [seconds for seconds, built in spent if built]
    found = []
    if watching:
        median, high = statistics.median(watching), _percentile(watching, 0.95)
        found.append(
            Figure(
                "a check cell in an open notebook",
                f"median under {CHECK_MEDIAN:g} s, 95th percentile under {CHECK_P95:g} s",
                f"median {median:.2f} s, 95th percentile {high:.2f} s, of {len(watching)} checks",
                median < CHECK_MEDIAN and high < CHECK_P95,
                load,
            )
        )
    if building:
        found.append(
            Figure(
                "the first check that builds a workspace with colcon, or launches one",
                "–",
                f"median {statistics.median(building):.1f} s, at most {max(building):.1f} s, of {len(building)} checks",
                None,
                load,
            )
        )
    return found


def execute(run: ExecuteRun, load: str) -> Figure:
    """All notebooks of the course against the longest of them."""
    beyond = run.seconds - run.longest
    return Figure(
        f"`autograder execute` of {run.notebooks} notebooks",
        "a few seconds beyond the longest one",
        f"{run.seconds:.0f} s, {beyond:.0f} s beyond {run.name} ({run.longest:.0f} s)",
        beyond <= EXECUTE_BEYOND,
        load,
    )


def regrade(spent: Sequence[tuple[float, float]], students: int, load: str) -> Figure:
    """Grading again what has not changed: pairs of wall and CPU seconds."""
    best, cpu = min(spent)
    return Figure(
        f"regrading an unchanged class of {students}",
        f"under {REGRADE:g} s",
        f"{best:.2f} s, of which {cpu:.2f} s of CPU (best of {len(spent)}; worst {max(spent)[0]:.2f} s)",
        best < REGRADE,
        load,
    )


def interrupt(spent: Sequence[float], load: str) -> Figure:
    """Ctrl-C while notebooks run."""
    return Figure(
        "from Ctrl-C to the end of `autograder grade`",
        f"under {INTERRUPT:g} s",
        f"{', '.join(f'{seconds:.1f}' for seconds in spent)} s, each time going on where it was stopped",
        max(spent) < INTERRUPT,
        load,
    )


def box_start(measured: BoxStart, load: str) -> Figure:
    """What a box adds to the start of a notebook."""
    return Figure(
        "what a box adds to an empty notebook",
        f"under {BOX_MS:g} ms",
        f"{1000 * measured.extra:.0f} ms: {1000 * measured.boxed:.0f} ms against {1000 * measured.unboxed:.0f} ms "
        f"(medians of {measured.turns})",
        1000 * measured.extra < BOX_MS,
        load,
    )


def overload(wrong: Sequence[str], verdicts: int, load: str) -> Figure:
    """Verdicts under overload."""
    return Figure(
        "verdicts with four times as many boxes as cores and two busy loops",
        "the same",
        f"{verdicts - len(wrong)} of {verdicts} the same",
        not wrong,
        load,
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


def _percentile(values: Sequence[float], share: float) -> float:
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, round(share * (len(ordered) - 1)))]
