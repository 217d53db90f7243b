"""The end of collecting, for the person who started it: every file has a line or is counted in one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from autograder.cards.readable import printable

if TYPE_CHECKING:
    from autograder.grading.collecting.collect import CollectReport


def show(report: CollectReport, console: Console | None = None) -> None:
    """Print what was placed where, and what was not and why.

    Args:
        report: What came of collecting.
        console: Standard output by default.
    """
    console = console or Console()

    def line(text: str, style: str = "") -> None:
        console.print(printable(text), style=style, markup=False, highlight=False, soft_wrap=True)

    for one in report.placed:
        when = f", handed in {one.when:%Y-%m-%d %H:%M} UTC" if one.when else ""
        late = ", late as the LMS says" if one.late else ""
        again = ", in place of an earlier one" if one.replaced else ""
        line(f"placed       {one.student}/{one.assignment}: {one.label}{when}{late}{again}")
    for other in report.older:
        line(f"older        {other.label}: {other.reason}")
    for other in report.others:
        line(f"left out     {other.label}: {other.reason}")
    for other in report.not_placed:
        line(f"not placed   {other.label}: {other.reason}", "yellow")
    for assignment, students in report.missing.items():
        line(f"nothing of   {assignment}: {', '.join(students)}")
    untimed = sorted({one.assignment for one in report.placed if one.late and one.when is None})
    if untimed:
        line(
            f"note         {', '.join(untimed)}: the LMS marks work as late and does not say when it came, so "
            "nothing is taken off for it"
        )
    for time in report.unread_times:
        line(
            f"note         the time “{time}” in a name could not be read, so nothing says when that work was handed "
            "in: have the system show itself in English, and download again",
            "yellow",
        )
    if report.by_their_names:
        line("note         the class has no students.csv: folders have the names that the LMS uses")
    line(
        f"{len(report.placed)} placed, {report.unchanged} unchanged, {len(report.older)} older, "
        f"{len(report.not_placed)} not placed, {report.left_out} files that are no notebooks"
        + (f", {len(report.others)} for other assignments" if report.others else "")
    )
    if report.placed:
        line(f"Then         ./course grade {report.path}")
