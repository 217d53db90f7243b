"""Writes the top of a feedback page: the student's name, and a table of the exercises with points.

This replaces the top of nbgrader's own page, where the student's name is missing, and each exercise is called "Test
cell".
"""

from __future__ import annotations

import contextlib
from html import escape
from typing import TYPE_CHECKING, Any

import re2

from autograder import exercises
from autograder.cards.readable import printable
from autograder.grading.rebuilding.master import exercise_of
from autograder.grading.rebuilding.rebuild import grade_id, is_check, is_the_masters

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nbformat import NotebookNode

    from autograder.grading.gradebooks.gradebook_reading import CellEntry

WAITS = "waits_for_a_person"
"""The key of a remark for the student, such as "waits for your instructor", in a cell's nbgrader metadata. Only a cell
without final points has a remark.
"""
_FOR_A_PERSON, _TRIED_AGAIN = "waits for your instructor", "could not be checked, and is tried again"
_BEGIN, _END = '<div id="toc">', "</div>"
_LINK = re2.compile(r'(?s)<a\b[^>]*\bhref="([^"]*)"[^>]*>(.*?)</a>')
_LEADS_SOMEWHERE = re2.compile(r"#|[a-zA-Z][a-zA-Z+.-]*:")
_CELL = "padding: 4px 14px 4px 0; vertical-align: top; text-align: left"


def with_summary(body: str, notebook: NotebookNode, names: Mapping[str, Any]) -> str:
    """Return a page in which the student's name and a table of exercises replace nbgrader's list.

    Args:
        body: The page as HTML. Text by a student may follow nbgrader's list, but must not precede the list.
        notebook: The notebook of the page, with points filled in.
        names: The values that the template gets about the student and the points.
    """
    before, begin, rest = body.partition(_BEGIN)
    _, end, after = rest.partition(_END)
    if not end:
        return body
    lines = "".join(
        f'<tr><td style="{_CELL}">{name}</td><td style="{_CELL}; white-space: nowrap">{points}</td>'
        f'<td style="{_CELL}">{words}</td></tr>'
        for name, points, words in _lines(notebook, names)
    )
    student, name = str(names.get("student", "")), str(names.get("name", ""))
    heading = f"{name} ({student})" if name else student
    return f"{before}{begin}<p><strong>{escape(printable(heading))}</strong></p><table>{lines}</table>{end}{after}"


def cards_first(notebook: NotebookNode) -> list[tuple[bool, bool]]:
    """Move the check cells to the top of a notebook, because their outputs are the cards.

    Returns:
        For each cell, two booleans: True if a block of given cells begins with the cell, and True if a block of given
        cells ends with the cell. The page folds these blocks.
    """
    notebook.cells = sorted(notebook.cells, key=lambda cell: not is_check(cell))
    given = [is_the_masters(cell) and not is_check(cell) for cell in notebook.cells]
    return [
        (one and not before, one and not after)
        for before, one, after in zip([False, *given], given, [*given[1:], False], strict=False)
    ]


def mark_waiting(notebook: NotebookNode, cells: Mapping[str, CellEntry]) -> None:
    """Mark the cells whose points a person or the judge still has to give.

    Args:
        notebook: A graded notebook. It is changed.
        cells: The notebook's entries in the gradebook, by grade_id.
    """
    for cell in notebook.cells:
        entry = cells.get(grade_id(cell))
        if entry is not None and entry.waits:
            unchecked = is_check(cell) and entry.by_hand is None
            cell.metadata.nbgrader[WAITS] = _TRIED_AGAIN if unchecked else _FOR_A_PERSON


def without_dead_links(page: str) -> str:
    """Turn links to files next to the page into plain text, because the page is sent without these files."""
    return _LINK.sub(lambda link: link[0] if _LEADS_SOMEWHERE.match(link[1]) else link[2], page)


def _lines(notebook: NotebookNode, names: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield a line of the table for each cell with points: the name, the points, and a remark, as HTML."""
    for cell in notebook.cells:
        marks = cell.metadata.get("nbgrader", {})
        if not (marks.get("grade") or marks.get("task")):
            continue
        score, most = float(marks.get("score") or 0), float(marks.get("points") or 0)
        link = f'<a href="#{escape(grade_id(cell))}">{escape(_title(cell))}</a>'
        word = "✓ all points" if score >= most else "◐ some points, see below" if score > 0 else "✗ see below"
        if marks.get(WAITS):
            word = f"… {marks[WAITS]}"
        if marks.get("comment"):
            word += f', <a href="#comment-{escape(grade_id(cell))}">with a comment</a>'
        yield link, f"{score:g} of {most:g}", word
    if names.get("late_penalty"):
        yield "Being late", f"−{float(names['late_penalty']):g}", escape(str(names.get("why_late", "")))


def _title(cell: NotebookNode) -> str:
    """Return the exercise's title if the judge checks the cell; otherwise the name of the cell."""
    name = grade_id(cell)
    if is_check(cell) and is_the_masters(cell):
        with contextlib.suppress(LookupError):
            return str(exercises.get(exercise_of(name)).title)
    return name.replace("_", " ")
