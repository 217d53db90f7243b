"""Parses the text of a master into a list of cells, with their kinds and line numbers, and with hints and figures.

Students copy code from earlier cells into the programs of a package. In a master, a line ``### COPY`` names the code,
which is then copied automatically, so that copy and original cannot differ::

    ### BEGIN SOLUTION
    # TODO: copy your class TalkerNode here.
    ### COPY TalkerNode
    ### END SOLUTION

Text cells contain two things that Markdown does not have: hints and figures. For hints, which open one at a time, an
author writes one block after the other::

    :::{hint} Where do I begin?
    With the publisher.
    :::

    :::{hint} And then?
    With the timer.
    :::

In the notebook, hints become ``<details>``. Each hint is put inside the hint before it, so that a student cannot see
the second before opening the first.

Figures are embedded in a notebook, so that it can be moved to any folder. They are embedded as PNGs, because JupyterLab
does not show an attached SVG. :mod:`autograder.masters.figure_drawing` draws each PNG from its SVG, and stores a digest
of the SVG in it, so that a PNG that is older than its SVG is noticed. Both files are committed.
"""

from __future__ import annotations

import ast
import base64
import hashlib
import re  # noqa: TID251  (not what a student handed in)
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from jupytext.myst import MystMetadataParsingError, myst_to_notebook
from nbformat import ValidationError

from autograder.masters.code_cells import find_region, has_magic
from autograder.masters.master_files import CellError, MasterError

if TYPE_CHECKING:
    from pathlib import Path


MASTER_HEADER = """\
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


_TAGS = {kind.value: kind for kind in CellRole if kind not in (CellRole.TEXT, CellRole.MANUAL)}
COPY_LINE = re.compile(r"^### COPY (?P<names>\w+(?: \w+)*)$", re.MULTILINE)
_OPTIONS = {"tags", "grade_id"}


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
    text = _read_master(path)
    try:
        notebook = myst_to_notebook(text, add_source_map=True)
    except MystMetadataParsingError as error:
        raise MasterError(path, None, "no_yaml", error=error) from error
    except (ValidationError, AttributeError) as error:
        reason = str(error).split("\n", 1)[0]
        raise MasterError(path, 1, "bad_header", reason=reason, header=MASTER_HEADER) from error
    lines = text.splitlines()
    first_lines = notebook.metadata["source_map"]
    return [
        _cell(path, node, first_line, lines)
        for node, first_line in zip(notebook.cells, first_lines, strict=True)
    ]


def _read_master(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise MasterError(path, None, "no_file") from error
    except UnicodeDecodeError as error:
        raise MasterError(path, None, "no_utf8") from error


def _cell(path: Path, node: Any, place: int, lines: list[str]) -> MasterCell:
    if node.cell_type == "markdown":
        first = next(number for number in range(place, len(lines)) if lines[number].strip()) + 1
        try:
            text, figures = _with_attached_figures(path.parent, _with_nested_hints(node.source))
            if node.metadata:
                return _question(path, node.metadata, text, first, figures)
            return MasterCell(CellRole.TEXT, text, first, first, attachments=figures)
        except CellError as error:
            raise error.at(path, first) from error
    if node.cell_type == "raw":
        raise MasterError(path, place, "raw_cell")
    kind, grade_id = _options(path, node.metadata, place)
    if not node.source.strip():
        raise MasterError(path, place, "empty_cell")
    # The text of the cell begins below its fence and options.
    first_line = node.source.split("\n", 1)[0].strip()
    below = (number + 1 for number in range(place, len(lines)) if lines[number].strip() == first_line)
    return MasterCell(kind, node.source, place, next(below, place), grade_id)


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
        raise MasterError(path, line, "options_of_text")
    return MasterCell(CellRole.MANUAL, text, line, line, str(name), figures, float(points))


def _options(path: Path, metadata: Any, line: int) -> tuple[CellRole, str | None]:
    for option in sorted(set(metadata) - _OPTIONS):
        raise MasterError(path, line, "unknown_option", option=option, known=", ".join(sorted(_OPTIONS)))
    tags = metadata.get("tags", [])
    tags = [tags] if isinstance(tags, str) else list(tags)
    for tag in tags:
        if tag == CellRole.MANUAL:
            raise MasterError(path, line, "manual_code")
        if tag not in _TAGS:
            raise MasterError(path, line, "unknown_tag", tag=tag, known=", ".join(_TAGS))
    if len(tags) > 1:
        raise MasterError(path, line, "several_tags", count=len(tags))
    kind = _TAGS[tags[0]] if tags else CellRole.GIVEN
    grade_id = metadata.get("grade_id")
    return kind, None if grade_id is None else str(grade_id)


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
        if cell.kind not in (CellRole.TEXT, CellRole.MANUAL) and COPY_LINE.search(cell.source):
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
                known = ", ".join(defined) or "nothing"
                raise MasterError(master, number, "copy_of_nothing", name=name, known=known)
        return "\n\n\n".join(defined[name] for name in names)

    return replace(cell, source=COPY_LINE.sub(copy, cell.source))


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
        decorators = getattr(node, "decorator_list", [])
        first = min([node.lineno, *(decorator.lineno for decorator in decorators)])
        text = "\n".join(lines[first - 1 : node.end_lineno])
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            found[node.name] = text
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found[node.targets[0].id] = text
    return found


_HINT_OPENING = re.compile(r":::\{hint\}\s*(?P<question>.*?)\s*")
_HINT_CLOSING = ":::"
_CODE = re.compile(r"`([^`]+)`")


@dataclass(frozen=True)
class _Hint:
    """A hint: the question that it answers, and the answer in Markdown."""

    question: str
    answer: str


def _with_nested_hints(markdown: str) -> str:
    """Return ``markdown`` with every run of hint blocks replaced by nested ``<details>``.

    Raises:
        CellError: A hint has no question or no answer, contains another hint, or is never closed.
    """
    lines = markdown.split("\n")
    result: list[str] = []
    run: list[_Hint] = []
    offset = 0
    while offset < len(lines):
        opening = _HINT_OPENING.fullmatch(lines[offset])
        if opening:
            end = _closing(lines, offset)
            answer = "\n".join(lines[offset + 1 : end]).strip("\n")
            if not opening["question"] or not answer.strip():
                raise CellError(offset, "empty_hint")
            run.append(_Hint(opening["question"], answer))
            offset = end + 1
            continue
        # Blank lines between two hints do not end the run.
        if run and lines[offset].strip():
            result.extend([_nested(run), ""])
            run = []
        if not run:
            result.append(lines[offset])
        offset += 1
    if run:
        result.append(_nested(run))
    return "\n".join(result)


def _closing(lines: list[str], opening: int) -> int:
    for offset in range(opening + 1, len(lines)):
        if _HINT_OPENING.fullmatch(lines[offset]):
            break
        if lines[offset].strip() == _HINT_CLOSING:
            return offset
    raise CellError(opening, "open_hint")


def _nested(hints: list[_Hint]) -> str:
    text = ""
    for number, hint in reversed(list(enumerate(hints, 1))):
        inner = f"{hint.answer}\n\n{text}" if text else f"{hint.answer}\n"
        question = _CODE.sub(r"<code>\1</code>", hint.question)  # no Markdown is read in a line of HTML
        text = (
            f"<details>\n<summary><b>Hint {number} of {len(hints)}.</b> {question}</summary>\n"
            # The blank lines make JupyterLab read the content as Markdown.
            f"<blockquote>\n\n{inner}\n</blockquote>\n</details>\n"
        )
    return text.rstrip("\n")


_FIGURE_REFERENCE = re.compile(r"!\[\]\((?P<path>[^)\s]+\.svg)\)")
"""Matches a line of a master that shows a figure. The alternative text is in the SVG, not in this line."""
DIGEST_KEYWORD = b"Drawn from SVG"
_SVG = "{http://www.w3.org/2000/svg}"


def _with_attached_figures(folder: Path, markdown: str) -> tuple[str, dict[str, dict[str, str]]]:
    """Return the text of a text cell with its figures as attachments.

    Args:
        folder: The folder of the master. References to figures are relative to it.
        markdown: The text of the cell.

    Returns:
        The text with references to the attachments, and the attachments by name.

    Raises:
        CellError: A figure is missing, has no description, or its PNG is out of date.
    """
    figures: dict[str, dict[str, str]] = {}

    def shown(reference: re.Match[str]) -> str:
        line = markdown.count("\n", 0, reference.start())
        name, words, png = _read_figure(folder / reference["path"], reference["path"], line)
        figures[name] = {"image/png": base64.b64encode(png).decode("ascii")}
        return f"![{words}](attachment:{name})"

    return _FIGURE_REFERENCE.sub(shown, markdown), figures


def figure_digest(svg: bytes) -> bytes:
    """Return the digest of an SVG. A PNG that was made from this SVG contains this digest, so an old PNG is noticed."""
    return hashlib.sha256(svg).hexdigest().encode("ascii")


def _read_figure(svg: Path, named: str, line: int) -> tuple[str, str, bytes]:
    """Return the name of a figure's PNG, the figure's description, and the PNG itself."""
    png = svg.with_suffix(".png")
    try:
        drawing, picture = svg.read_bytes(), png.read_bytes()
        root = ElementTree.fromstring(drawing)
    except FileNotFoundError as error:
        raise CellError(line, "figure_file", figure=named, file=error.filename) from error
    except ElementTree.ParseError as error:
        raise CellError(line, "figure_form", figure=named, error=error) from error
    words = [(root.findtext(f"{_SVG}{tag}") or "").strip() for tag in ("title", "desc")]
    if not all(words):
        raise CellError(line, "figure_words", figure=named)
    if DIGEST_KEYWORD + b"\0" + figure_digest(drawing) not in picture:
        raise CellError(line, "figure_stale", figure=named)
    # Brackets would end the alternative text of a Markdown image.
    return (png.name, " ".join(re.sub(r"[\[\]]", "", ". ".join(words)).split()), picture)
