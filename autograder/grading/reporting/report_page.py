"""Writes the report page about a class: one HTML file that needs no scripts, no network and no colors."""

from __future__ import annotations

import statistics
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import quote

from autograder import exercises
from autograder.cards.html_rendering import page_templates
from autograder.cards.readable_text import one_line
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError, clear_disk_errors, write_output
from autograder.grading.reporting import class_statistics as figures
from autograder.grading.reporting.class_table import ClassTable, read_table
from autograder.grading.returning.page_exporter import POLICY
from autograder.grading.table.rows import DROPPED, EXCUSED, NO_EXERCISE, columns, remarks_on
from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.grading.table.rows import Row


NAME = "report.html"
_LONGEST_NAME = 200


@dataclass(frozen=True)
class _Person:
    """A student as shown on the page.

    Attributes:
        shown: The name; or, if names are hidden, a number such as ``student 3``.
        links: The links to feedback pages by assignment, relative to this page; empty if names are hidden.
    """

    shown: str
    links: dict[str, str]


def write_report(
    path: Path, *, names: bool = True, to: Path | None = None, sections: Sequence[str] = ()
) -> Path:
    """Write the report page of a class.

    Args:
        path: The class directory.
        names: True to show names, with links to the feedback pages.
        to: The file to write; by default ``report.html`` in the class.
        sections: The sections whose students are shown; all students if empty.

    Returns:
        The absolute path of the file.

    Raises:
        GradingError: The class has no submissions, or cannot be read.
    """
    directory = ClassDirectory(path)
    to = (to or directory.path / NAME).absolute()
    with clear_disk_errors(directory.path), ClassStore(directory) as store:
        table = read_table(directory, sections)
        table.check_usable()
        if not figures.handed_in(table):
            raise GradingError("The class has no submissions yet, so nothing can be reported.")
        page = _page(directory, store, table, names=names, folder=to.parent)
        write_output(to, page.encode(), "--output")
    return to


def _page(
    directory: ClassDirectory, store: ClassStore, table: ClassTable, *, names: bool, folder: Path
) -> str:
    environment = page_templates("autograder.grading.reporting")
    people = _people(directory, table, names=names, folder=folder)
    there = figures.handed_in(table)
    totals = figures.totals(table).values()
    environment.filters["printable"] = printable
    template = environment.get_template("report.html.j2")
    return template.render(
        policy=POLICY,
        title=directory.path.name,
        table=table,
        people=people,
        there=there,
        absent=[student for student in table.students if student not in there],
        exercises=columns(table.rows),
        titles=_titles(columns(table.rows)),
        labs={name: directory.title(name, name) for name in table.assignments},
        rows={
            student: {
                (row.assignment, row.exercise): row
                for row in table.of(student)
                if row.exercise not in NO_EXERCISE
            }
            for student in table.students
        },
        dropped=_dropped(table),
        cell=_cell,
        mean=statistics.fmean(totals) if totals else None,
        median=statistics.median(totals) if totals else None,
        most=table.max_score(),
        bands=figures.bands(table),
        items=figures.items(table, store),
        mistakes=figures.mistakes(table),
        remarks=remarks_on(table.rows),
        names=names,
    )


def _people(directory: ClassDirectory, table: ClassTable, *, names: bool, folder: Path) -> dict[str, _Person]:
    if not names:
        return {student: _Person(f"student {place}", {}) for place, student in enumerate(table.students, 1)}
    people = {}
    for student in table.students:
        links = {}
        for assignment in table.assignments:
            pages = sorted((directory.path / "feedback" / student / assignment).glob("*.html"))
            if pages:
                # A feedback page outside the folder of the report page is linked by its absolute path.
                inside = pages[0].is_relative_to(folder)
                links[assignment] = quote(str(pages[0].relative_to(folder))) if inside else pages[0].as_uri()
        name = table.roster.students[student].name
        # Students choose their names in an LMS, so a name may be very long or have several lines.
        people[student] = _Person(one_line(f"{name} ({student})" if name else student, _LONGEST_NAME), links)
    return people


def _titles(headings: Mapping[tuple[str, str], str]) -> dict[str, str]:
    """Return the title of each exercise by the heading of its column; the lab follows if two have the same title."""
    titles = {}
    for (_, exercise), heading in headings.items():
        try:
            titles[heading] = exercises.get(exercise).title
        except LookupError:  # a cell of the instructor's own, or an exercise that the course no longer has
            titles[heading] = heading
    often = Counter(titles.values())
    return {
        heading: title if often[title] == 1 else f"{title} ({heading.partition('.')[0]})"
        for heading, title in titles.items()
    }


def _dropped(table: ClassTable) -> dict[str, list[str]]:
    """Return the assignments of each student that do not count because of ``drop_lowest``."""
    dropped = {
        one: [row.assignment for row in table.of(one) if row.exercise == DROPPED] for one in table.students
    }
    return {student: names for student, names in dropped.items() if names}


def _cell(row: Row | None) -> str:
    if row is None or row.is_blank:
        return "excused" if row and row.state == EXCUSED else "–"
    return f"{row.score:g}{row.mark}"
