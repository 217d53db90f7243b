"""Prints the result of collecting in a terminal, one line for every file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from autograder.cards.readable import printable
from autograder.grading.collecting.line import LineState
from autograder.grading.errors import course_command
from autograder.grading.running.progress import plain_line
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.grading.collecting.outcomes import CollectReport


def show(report: CollectReport, console: Console | None = None) -> None:
    """Print which files were placed and which were not, with the reasons.

    Args:
        report: The result of collecting.
        console: The console to print on; by default standard output.
    """
    console = console or Console()
    for text in _lines(report):
        style = "yellow" if text.startswith(LineState.NOT_PLACED) else ""
        plain_line(console, printable(text), style)


def _lines(report: CollectReport) -> Iterator[str]:
    for one in report.having(LineState.PLACED):
        when = f", handed in {one.when:%Y-%m-%d %H:%M} {one.when.tzinfo}" if one.when else ""
        late = ", late according to the LMS" if one.late else ""
        again = f", {one.reason}" if one.reason else ""
        yield f"placed       {one.student}/{one.assignment}: {one.label}{when}{late}{again}"
    for state in (LineState.EARLIER, LineState.BESIDE, LineState.LEFT_OUT, LineState.NOT_PLACED):
        for one in report.having(state):
            owner = f"{one.student}: " if one.student else ""
            also = (
                "; the student's notebook was collected, too"
                if state == LineState.BESIDE and one.student
                else ""
            )
            yield f"{state:<12} {one.label}: {owner}{one.reason}{also}"
    for assignment, students in report.missing.items():
        yield f"nothing of   {assignment}: {', '.join(students)}"
    untimed = {student for students in report.untimed.values() for student in students}
    for assignment, students in report.untimed.items():
        yield f"no time      {assignment}: {', '.join(students)}"
    if untimed:
        marked = any(one.late and one.student in untimed for one in report.outcomes)
        yield (
            "note         for these students, the time of handing in is unknown"
            + (", though the LMS marks some of them as late" if marked else "")
            + ", so they have no late penalty: write the time under handed_in in collected.csv"
        )
    for note in report.notes:
        yield f"note         {note}"
    counts = {state: len(report.having(state)) for state in LineState}
    yield ", ".join(f"{count} {state}" for state, count in counts.items())
    if counts[LineState.NOT_PLACED]:
        yield (
            f"note         {counted(report.waiting, 'line')} of {report.path / 'collected.csv'} to decide: write the "
            f"student or the assignment there, or yes or no under use; then type "
            f"{course_command('collect', report.path)}. "
            "If many names have the same form, --from or --names can describe it"
        )
    if counts[LineState.PLACED]:
        yield f"Then         {course_command('grade', report.path)}"
