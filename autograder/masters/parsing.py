"""Parses the text of a master into a list of cells, with their kinds and line numbers.

Students copy code from earlier cells into the programs of a package. In a master, a line ``### COPY`` names the code,
which is then copied automatically, so that copy and original cannot differ::

    ### BEGIN SOLUTION
    # TODO: copy your class TalkerNode here.
    ### COPY TalkerNode
    ### END SOLUTION
"""

from __future__ import annotations

import ast
import re  # noqa: TID251  (not what a student handed in)
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from jupytext.myst import MystMetadataParsingError, myst_to_notebook
from nbformat import ValidationError

from autograder.masters.code_cells import find_region, has_magic
from autograder.masters.master_errors import CellError, MasterError
from autograder.masters.text_cells import attach_figures, nest_hints

if TYPE_CHECKING:
    from pathlib import Path


HEADER = """\
---
jupytext:
  formats: md:myst
kernelspec:
  display_name: Python 3 (ipykernel)
  name: python3
---
"""


class CellRole(StrEnum):
    """The role of a cell. Except for the first, the value is the tag that an author may type."""

    TEXT = "text"
    """Markdown. Students may change it."""
    GIVEN = "given"
    """Code that is part of the explanation: locked and tracked. Code without a tag has this role."""
    DEMONSTRATION = "demonstration"
    """Code that only shows something. Students receive it like given code. It is skipped when a class is graded."""
    SOLUTION = "solution"
    """Code with a region that the student writes."""
    MANUAL = "manual"
    """A question, in text, that a person grades."""
    CHECK = "check"
    """The line of code that requests a verdict. It is locked and graded, and carries the exercise's points."""


TAGS = {kind.value: kind for kind in CellRole if kind not in (CellRole.TEXT, CellRole.MANUAL)}
COPY = re.compile(r"^### COPY (?P<names>\w+(?: \w+)*)$", re.MULTILINE)
OPTIONS = {"tags", "grade_id"}
MANUAL_FORM = '+++ {"tags": ["manual"], "points": 5, "grade_id": "some_name"}'
"""An example of the line with options that a master has above each question that a person grades."""


@dataclass(frozen=True)
class MasterCell:
    """One cell of a master.

    Attributes:
        kind: The role of the cell.
        source: The text of the cell, without the options at its top.
        line: The line of the master on which it begins, counted from 1.
        body_line: The line of the master on which ``source`` begins, counted from 1.
        grade_id: The name that the author gave; None if there is none.
        attachments: The figures of a text cell by name, in nbformat's form.
        points: The points of a question that a person grades; None for any other cell.
        folded: True if the notebook shows the cell folded.
    """

    kind: CellRole
    source: str
    line: int
    body_line: int
    grade_id: str | None = None
    attachments: dict[str, dict[str, str]] = field(default_factory=dict)
    points: float | None = None
    folded: bool = False


def parse_master(path: Path) -> list[MasterCell]:
    """Read the cells of a master.

    Raises:
        MasterError: The file is missing or not UTF-8 text, its options are not YAML, or an option is unknown.
    """
    text = _read(path)
    try:
        notebook = myst_to_notebook(text, add_source_map=True)
    except MystMetadataParsingError as error:
        raise MasterError(path, None, f"{error}.", "Correct the YAML options on that line.") from error
    except (ValidationError, AttributeError) as error:
        reason = str(error).split("\n", 1)[0]
        problem = f"Jupyter refuses the header: {reason}."
        raise MasterError(path, 1, problem, f"Begin with:\n{HEADER}") from error
    lines = text.splitlines()
    places = notebook.metadata["source_map"]
    return [_cell(path, node, place, lines) for node, place in zip(notebook.cells, places, strict=True)]


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise MasterError(path, None, "The master does not exist.", "Look at the file's name.") from error
    except UnicodeDecodeError as error:
        raise MasterError(path, None, "The file is not UTF-8 text.", "Save it as UTF-8.") from error


def _cell(path: Path, node: Any, place: int, lines: list[str]) -> MasterCell:
    if node.cell_type == "markdown":
        first = next(number for number in range(place, len(lines)) if lines[number].strip()) + 1
        try:
            text, figures = attach_figures(path.parent, nest_hints(node.source))
            if node.metadata:
                return _question(path, node.metadata, text, first, figures)
            return MasterCell(CellRole.TEXT, text, first, first, attachments=figures)
        except CellError as error:
            raise error.at(path, first) from error
    if node.cell_type == "raw":
        raise MasterError(path, place, "A chapter cannot contain raw cells.", "Make it Markdown or code.")
    kind, grade_id = _options(path, node.metadata, place)
    if not node.source.strip():
        raise MasterError(path, place, "An empty code cell.", "Write code in it, or delete it.")
    return MasterCell(kind, node.source, place, _body_line(node.source, place, lines), grade_id)


def _question(
    path: Path, metadata: Any, text: str, line: int, figures: dict[str, dict[str, str]]
) -> MasterCell:
    """Read a text cell that has options. Only a question that a person grades may have options."""
    points, name = metadata.get("points"), metadata.get("grade_id")
    is_worth = isinstance(points, int | float) and not isinstance(points, bool) and points > 0
    if (
        set(metadata) != {"tags", "points", "grade_id"}
        or list(metadata["tags"]) != [CellRole.MANUAL]
        or not is_worth
    ):
        raise MasterError(
            path,
            line,
            "A text cell may have options only if it is a question that a person grades.",
            f"Write: '{MANUAL_FORM}'.",
        )
    return MasterCell(CellRole.MANUAL, text, line, line, str(name), figures, float(points))


def _options(path: Path, metadata: Any, line: int) -> tuple[CellRole, str | None]:
    for option in sorted(set(metadata) - OPTIONS):
        raise MasterError(
            path, line, f"Unknown cell option '{option}'.", f"Known are: {', '.join(sorted(OPTIONS))}."
        )
    tags = metadata.get("tags", [])
    tags = [tags] if isinstance(tags, str) else list(tags)
    for tag in tags:
        if tag == CellRole.MANUAL:
            raise MasterError(path, line, "A person grades text, not code.", f"Begin with '{MANUAL_FORM}'.")
        if tag not in TAGS:
            raise MasterError(path, line, f"Unknown tag '{tag}'.", f"Known are: {', '.join(TAGS)}.")
    if len(tags) > 1:
        raise MasterError(
            path, line, f"A cell with {len(tags)} tags.", "A cell may have only one: keep one tag."
        )
    kind = TAGS[tags[0]] if tags else CellRole.GIVEN
    grade_id = metadata.get("grade_id")
    return kind, None if grade_id is None else str(grade_id)


def _body_line(source: str, place: int, lines: list[str]) -> int:
    """Return the line on which the text of a code cell begins, below its fence and options."""
    first = source.split("\n", 1)[0]
    for number in range(place, len(lines)):
        if lines[number].strip() == first.strip():
            return number + 1
    return place


def with_copies(master: Path, cells: list[MasterCell]) -> list[MasterCell]:
    """Return the cells, with each line ``### COPY <names>`` replaced by the definitions of these names.

    Args:
        master: The master of the cells.
        cells: The cells as they were parsed.

    Raises:
        MasterError: No cell above the line defines one of the names.
    """
    defined: dict[str, str] = {}
    result = []
    for cell in cells:
        if cell.kind not in (CellRole.TEXT, CellRole.MANUAL) and COPY.search(cell.source):
            cell = _copied(master, cell, defined)
        elif cell.kind in (CellRole.SOLUTION, CellRole.GIVEN) and not has_magic(cell.source):
            defined |= _definitions(cell)
        result.append(cell)
    return result


def _copied(master: Path, cell: MasterCell, defined: dict[str, str]) -> MasterCell:
    def copy(line: re.Match[str]) -> str:
        names = line["names"].split()
        for name in names:
            if name not in defined:
                number = cell.body_line + cell.source.count("\n", 0, line.start())
                remedy = f"Defined so far: {', '.join(defined) or 'nothing'}."
                raise MasterError(
                    master, number, f"'### COPY' names '{name}', which no cell above defines.", remedy
                )
        return "\n\n\n".join(defined[name] for name in names)

    return replace(cell, source=COPY.sub(copy, cell.source))


def _definitions(cell: MasterCell) -> dict[str, str]:
    """Return the functions, classes and constants that a cell defines, with their solutions, by name."""
    source = cell.source
    try:
        if cell.kind is CellRole.SOLUTION:
            source = find_region(source).solved
        body = ast.parse(source).body
    except (CellError, SyntaxError):
        return {}  # a later step reports the error, with its line
    lines = source.split("\n")
    found = {}
    for node in body:
        text = "\n".join(lines[node.lineno - 1 : node.end_lineno])
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            found[node.name] = text
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found[node.targets[0].id] = text
    return found
