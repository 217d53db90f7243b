"""Turns a master into nbgrader's source notebook: checks its cells, names them, and adds metadata and set-up cells.

An author types a tag, but nbgrader needs eight lines of metadata for each cell. This module adds them.

The name of a cell is stable and readable, and never random. It must not change when a typo is corrected, because
nbgrader matches a submission's cells by name, and refuses to change the names of an assignment that has submissions.
So the name comes from what the cell defines or checks, and not from its text.

Two cells are added to each notebook, so that it can also run outside of ``./course lab``, for example in Colab. One
contains links that open the notebook in such a service, the other sets up the course there. They come after the text at
the top of the notebook. In ``./course lab``, and when a class is graded, they do nothing. They are added only if the
course's folder contains the code for the set-up (:data:`SET_UP_CODE`).
"""

from __future__ import annotations

import ast
import hashlib
import re  # noqa: TID251  (not what a student handed in)
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jinja2 import Template
from nbformat import NotebookNode, from_dict
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from autograder import course, exercises
from autograder.masters.check_cells import CheckCall, exercise_points, read_check
from autograder.masters.code_cells import (
    find_model_answer,
    find_region,
    has_magic,
    mentions_a_region,
    python_of,
)
from autograder.masters.master_cells import CellRole, MasterCell, parse_master, with_copies
from autograder.masters.master_files import CellError, MasterError, before_and_after, chapter_path
from autograder.masters.notebook_map import link_to, notebook_map

_HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*$", re.MULTILINE)
_FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_LONGEST = 48
"""The maximum length of a heading within a cell's name, in characters; nbformat allows 64 in an id."""
_GRADE_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
_SCHEMA_VERSION = 3
"""The version of nbgrader's cell metadata."""

# The metadata do not contain versions of Python or packages, so that the chapters are the same on every machine.
_NOTEBOOK_METADATA: dict[str, Any] = {
    "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
    "language_info": {
        "codemirror_mode": {"name": "ipython", "version": 3},
        "file_extension": ".py",
        "mimetype": "text/x-python",
        "name": "python",
        "nbconvert_exporter": "python",
        "pygments_lexer": "ipython3",
    },
}

Points = Callable[[CheckCall], float]


@dataclass(frozen=True)
class NamedCell:
    """A cell of a master, with everything that nbgrader has to know about it.

    Attributes:
        cell: The cell in the master.
        name: The id of the cell. If nbgrader tracks the cell, this is also its grade_id.
        check: The call in a check cell; None for any other cell.
        points: The points of a check cell or of a question that a person grades; None for any other cell.
    """

    cell: MasterCell
    name: str
    check: CheckCall | None = None
    points: float | None = None


def source_notebook(master: Path, *, points: Points = exercise_points) -> NotebookNode:
    """Return the nbgrader source notebook of ``master``, with solutions.

    Args:
        master: A MyST Markdown file.
        points: A function that returns the points of an exercise; by default, it reads them from the exercise.

    Raises:
        MasterError: The master cannot be used. The message says where, why, and what to do.
    """
    return notebook_of(named_cells(master, points=points))


def notebook_of(cells: list[NamedCell]) -> NotebookNode:
    """Return the nbgrader source notebook with these cells and their solutions."""
    notebook = new_notebook(metadata=from_dict(_NOTEBOOK_METADATA))
    notebook.nbformat_minor = 5
    notebook.cells = [_node(named) for named in cells]
    return notebook


def named_cells(master: Path, *, points: Points = exercise_points) -> list[NamedCell]:
    """Return the cells of ``master``, checked and named.

    Raises:
        MasterError: The master cannot be used; see :func:`source_notebook`.
    """
    try:
        cells = _with_set_up_cells(master, with_copies(master, parse_master(master)))
    except course.BrokenChapter as error:
        raise MasterError(master, None, "broken_file", error=error) from error
    cells += _links(master)
    named = list(_name_all(master, cells, points))
    _unique(master, named)
    _subjects_are_solutions(master, named)
    return named


def _links(master: Path) -> Iterator[MasterCell]:
    """Yield a cell with links to the previous and the next notebook; nothing if there is neither.

    At both ends of a chapter, a map of all notebooks comes before the links.
    """
    around = before_and_after(master)
    ways = zip(("← Previous: {}", "Next: {} →"), around, strict=True)
    links = [way.format(link_to(other, master)) for way, other in ways if other is not None]
    if links:
        at_an_end = any(other is None or other.parents[1] != master.parents[1] for other in around)
        parts = [*([notebook_map(master)] if at_an_end else []), " · ".join(links)]
        yield MasterCell(CellRole.TEXT, "\n\n".join(parts), line=0, body_line=0)


def _name_all(master: Path, cells: list[MasterCell], points: Points) -> Iterator[NamedCell]:
    taken: Counter[str] = Counter()
    section = "start"

    def numbered(wanted: str) -> str:
        """Return ``wanted`` the first time, then with a number added: ``given-talker``, ``given-talker-2``."""
        taken[wanted] += 1
        return wanted if taken[wanted] == 1 else f"{wanted}-{taken[wanted]}"

    for cell in cells:
        if cell.kind is CellRole.TEXT:
            headings = _HEADING.findall(_FENCED.sub("", cell.source))
            section = headings[-1] if headings else section
            # A text cell has no grade_id, so its name is made from its text.
            yield NamedCell(cell, numbered("text-" + hashlib.sha256(cell.source.encode()).hexdigest()[:10]))
            continue
        _region_where_it_belongs(master, cell)
        if cell.kind is CellRole.MANUAL:
            yield NamedCell(cell, str(cell.grade_id), points=cell.points)
        elif cell.kind is CellRole.CHECK:
            check = read_check(master, cell)
            yield NamedCell(cell, exercises.grade_id(check.exercise), check, points(check))
        elif cell.kind is CellRole.SOLUTION:
            yield NamedCell(cell, cell.grade_id or _defined_name(master, cell))
        else:
            yield NamedCell(cell, cell.grade_id or numbered(f"{CellRole.GIVEN}-{_slug(section)}"))


def _slug(text: str) -> str:
    """Return a text in lower case, with a dash for everything except letters and digits."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower())[:_LONGEST].strip("-") or "cell"


def _defined_names(source: str) -> list[str]:
    """Return the names of the functions and classes at the top level of a code cell, or of the Python file in the cell.

    Raises:
        SyntaxError: The cell contains Python that is not valid.
    """
    definitions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node.name for node in ast.parse(python_of(source)).body if isinstance(node, definitions)]


def _region_where_it_belongs(master: Path, cell: MasterCell) -> None:
    try:
        if cell.kind is CellRole.MANUAL:
            find_model_answer(cell.source)
        elif cell.kind is CellRole.SOLUTION:
            _is_python(master, cell, find_region(cell.source).unsolved)
        elif mentions_a_region(cell.source):
            raise MasterError(master, cell.line, "stray_region")
    except CellError as error:
        raise error.at(master, cell.body_line) from error


def _is_python(master: Path, cell: MasterCell, unsolved: str) -> None:
    """Check that a solution cell is valid Python, both with and without its solution."""
    try:
        _defined_names(cell.source)
    except SyntaxError as error:
        line = cell.body_line + (error.lineno or 1) - 1
        raise MasterError(master, line, "broken_solution", error=error.msg) from error
    try:
        _defined_names(unsolved)
    except SyntaxError as error:
        raise MasterError(master, cell.line, "broken_stub", error=error.msg) from error


def _defined_name(master: Path, cell: MasterCell) -> str:
    names = _defined_names(cell.source)
    if len(names) != 1:
        raise MasterError(master, cell.line, "no_single_name", count=len(names))
    return names[0]


def _unique(master: Path, named: list[NamedCell]) -> None:
    seen: dict[str, int] = {}
    for item in named:
        if not _GRADE_ID.fullmatch(item.name):
            raise MasterError(master, item.cell.line, "bad_grade_id", name=item.name)
        if item.name in seen:
            other = seen[item.name]
            raise MasterError(master, item.cell.line, "grade_id_twice", name=item.name, other=other)
        seen[item.name] = item.cell.line


def _subjects_are_solutions(master: Path, named: list[NamedCell]) -> None:
    """Check that the subject of each check is defined in a solution cell above, because the student has to write it."""
    written: set[str] = set()
    on_disk = False
    for item in named:
        # A path may be a whole workspace, so any solution cell that writes a file counts.
        if item.cell.kind is CellRole.SOLUTION and has_magic(item.cell.source):
            on_disk = True
        elif item.cell.kind is CellRole.SOLUTION:
            written.update(_defined_names(item.cell.source))
        elif item.check is None or (item.check.is_path and on_disk):
            continue
        elif item.check.is_path:
            raise MasterError(master, item.cell.line, "nothing_written", subject=item.check.subject)
        elif item.check.subject not in written:
            known = ", ".join(sorted(written)) or "nothing so far"
            words = {"subject": item.check.subject, "known": known}
            raise MasterError(master, item.cell.line, "undefined_subject", **words)


def _node(named: NamedCell) -> NotebookNode:
    cell = named.cell
    metadata: dict[str, Any] = {} if cell.kind is CellRole.TEXT else {"nbgrader": _nbgrader(named)}
    if cell.kind is CellRole.DEMONSTRATION:
        metadata["tags"] = [CellRole.DEMONSTRATION.value]
    if cell.folded:
        # The first key is for Colab, the second for JupyterLab.
        metadata |= {"cellView": "form", "jupyter": {"source_hidden": True}}
    if cell.kind in (CellRole.TEXT, CellRole.MANUAL):
        figures = {"attachments": from_dict(cell.attachments)} if cell.attachments else {}
        return new_markdown_cell(cell.source, id=named.name, metadata=from_dict(metadata), **figures)
    return new_code_cell(cell.source, id=named.name, metadata=from_dict(metadata))


def _nbgrader(named: NamedCell) -> dict[str, Any]:
    kind = named.cell.kind
    metadata: dict[str, Any] = {
        "cell_type": "markdown" if kind is CellRole.MANUAL else "code",
        "grade": kind in (CellRole.CHECK, CellRole.MANUAL),
        "grade_id": named.name,
        "locked": kind not in (CellRole.SOLUTION, CellRole.MANUAL),
        "schema_version": _SCHEMA_VERSION,
        "solution": kind in (CellRole.SOLUTION, CellRole.MANUAL),
        "task": False,
    }
    if named.points is not None:
        metadata["points"] = int(named.points) if named.points == int(named.points) else named.points
    return metadata


SET_UP_CELL = "given-set-up"
"""The grade_id of the cell that sets up the course."""
SET_UP_CODE = "environment/plain_kernel.py"
"""A file of the course, by which the cell recognizes the course's folder."""
_SET_UP_SOURCE = Path(__file__).with_name("set_up_cell.py.j2")


def service_links(address: str, notebook: str) -> dict[str, str]:
    """Return the addresses that open a notebook of a repository in various services, by the name of the service.

    Args:
        address: The address of the repository, as :func:`autograder.course.repository` returns it.
        notebook: The path of the notebook in the repository.
    """
    name = address.removeprefix(course.GITHUB)
    path = quote(notebook)
    return {
        "Colab": f"https://colab.research.google.com/github/{name}/blob/{course.BRANCH}/{path}",
        "Codespaces": f"https://codespaces.new/{name}",
        "Binder": f"https://mybinder.org/v2/gh/{name}/{course.BRANCH}?urlpath=lab/tree/{path}",
    }


def _with_set_up_cells(master: Path, cells: list[MasterCell]) -> list[MasterCell]:
    """Return a master's cells, with the set-up cells of this module inserted before the first cell that is not text."""
    root = master.parents[3]
    first = next((place for place, cell in enumerate(cells) if cell.kind is not CellRole.TEXT), None)
    if first is None or not (root / SET_UP_CODE).is_file():
        return cells
    address = course.repository(root)
    added = []
    if address:
        notebook = chapter_path(root, master).relative_to(root).as_posix()
        services = " · ".join(f"[{name}]({link})" for name, link in service_links(address, notebook).items())
        text = f"Nothing installed? Open this notebook in {services}."
        added.append(MasterCell(CellRole.TEXT, text, line=0, body_line=0))
    archive = course.archive(address) if address else ""
    source = Template(_SET_UP_SOURCE.read_text(encoding="utf-8")).render(part=SET_UP_CODE, archive=archive)
    added.append(
        MasterCell(CellRole.DEMONSTRATION, source, line=0, body_line=0, grade_id=SET_UP_CELL, folded=True)
    )
    return [*cells[:first], *added, *cells[first:]]
