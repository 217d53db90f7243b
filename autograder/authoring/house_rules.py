"""Checks a master against the house rules for masters, such as a limit on the words before the first task."""

from __future__ import annotations

import itertools
import re  # noqa: TID251  (not what a student handed in)
from typing import TYPE_CHECKING

from autograder.masters.code_cells import find_region
from autograder.masters.parsing import COPY, CellRole, parse_master
from autograder.masters.source import named_cells

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from autograder.masters.source import NamedCell

HEAD, BEFORE_A_TASK, SOLUTION = 150, 400, 8
"""Three limits of a master: the words before the first code cell, the words before the first task, and the lines that
a student writes in one cell.
"""
_MINUTES = re.compile(r"^\*\d+ minutes · for ", re.MULTILINE)
_PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
"""Matches a figure. The figure's alternative text does not count as words of the master, because it replaces the
figure for readers who cannot see it.
"""
PREDICTION = "**Before you run it:**"
"""The first words of a question that students answer before they run a demonstration."""
_PARAGRAPH = re.compile(r"\n\s*\n|\n(?=\d+\. |- )")
_CODE = re.compile(r"`[^`]*`|\]\([^)]*\)")
"""Matches code and the address of a link. Parentheses there do not count as parentheses of a text."""
_PARENTHESIS = re.compile(r"\([^)]*\)")
_FOLD = re.compile(r"<details>.*?</details>", re.DOTALL)
"""Matches folded text. Its words do not count, because students open it only if they want to."""
_SELF_CHECK = re.compile(
    r"\*\*Check yourself:\*\*.*?\n\n(?P<choices>(?:<details>.*?</details>\s*)*)", re.DOTALL
)
_REPLY = re.compile(r"</summary>\s*(\S)")


def broken_rules(master: Path) -> list[str]:
    """Return a line for each house rule that a master breaks. A line contains the rule's name and what to write.

    Args:
        master: The path of a file ``lab.md``.

    Raises:
        autograder.masters.master_errors.MasterError: The file is not a valid master.
    """
    copying = {cell.line for cell in parse_master(master) if COPY.search(cell.source)}
    cells = [
        one for one in named_cells(master) if one.cell.line
    ]  # the last cell, which links to the neighboring labs, is left out
    return [
        *_beginning(cells),
        *_solutions(one for one in cells if one.cell.line not in copying),
        *_introductions(cells),
        *_predictions(cells),
        *_tasks(cells),
        *_self_checks(filter(_is_text, cells)),
        *_end(cells),
    ]


def _beginning(cells: list[NamedCell]) -> Iterator[str]:
    head = list(itertools.takewhile(_is_text, cells))
    if _words(head) > HEAD:
        yield f"begin by doing: {_words(head)} words before the first code cell; at most {HEAD} are allowed"
    if not head or not _MINUTES.search(head[0].cell.source):
        yield (
            "minutes: write in the first text how long the lab takes and for whom, such as *20 minutes · for "
            "beginners*"
        )
    task = next((place for place, one in enumerate(cells) if one.cell.kind is CellRole.SOLUTION), 0)
    if (before := _words(filter(_is_text, cells[:task]))) > BEFORE_A_TASK:
        yield f"the first task comes soon: {before} words before the first task; at most {BEFORE_A_TASK} are allowed"


def _solutions(cells: Iterable[NamedCell]) -> Iterator[str]:
    for one in cells:
        if one.cell.kind is CellRole.SOLUTION:
            written = sum(bool(line.strip()) for line in find_region(one.cell.source).answer)
            if not 1 <= written <= SOLUTION:
                yield (
                    f"a task is small: the cell {one.name} (line {one.cell.line}) asks for {written} lines; at most "
                    f"{SOLUTION} are allowed: give students the other lines, or split the cell in two"
                )


def _introductions(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        said = [line for line in before.cell.source.splitlines() if line.strip() and not line.startswith("#")]
        if not _is_text(one) and not (_is_text(before) and said):
            yield f"a code cell is introduced: write a sentence before the code cell at line {one.cell.line}"


def _predictions(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        # A cell that only defines or stops something has no result that a student could predict.
        shows = one.cell.source.startswith("%%bash") or "print(" in one.cell.source
        if one.cell.kind is CellRole.DEMONSTRATION and shows and PREDICTION not in before.cell.source:
            yield (
                f"a demonstration is predicted: write a question '{PREDICTION} …?' before line {one.cell.line}, "
                "and its answer in a <details>"
            )


def _tasks(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        if one.cell.kind is CellRole.SOLUTION and _is_text(before):
            for paragraph in _PARAGRAPH.split(_FOLD.sub("", before.cell.source)):
                if len(_PARENTHESIS.findall(_CODE.sub("", paragraph))) > 1:
                    yield (
                        f"a task is plain: a paragraph before line {one.cell.line} has more than one "
                        "parenthesis: write sentences, or a list 'What counts' below the task"
                    )


def _self_checks(texts: Iterable[NamedCell]) -> Iterator[str]:
    for one in texts:
        for found in _SELF_CHECK.finditer(one.cell.source):
            replies = _REPLY.findall(found["choices"])
            if set(replies) != {"✓", "✗"} or replies.count("✓") > 1:
                yield (
                    f"a self-check is answered by a click: in the text at line {one.cell.line}, write a <details> for "
                    "each choice. Its reply begins with ✓ for the right choice and with ✗ for the others"
                )


def _end(cells: list[NamedCell]) -> Iterator[str]:
    if not cells or "https://docs.ros.org/en/jazzy/" not in cells[-1].cell.source:
        yield "closing link: add a link for further reading to the last text, such as https://docs.ros.org/en/jazzy/..."


def _is_text(one: NamedCell) -> bool:
    return one.cell.kind is CellRole.TEXT


def _words(cells: Iterable[NamedCell]) -> int:
    return len(_FOLD.sub("", _PICTURE.sub("", "\n".join(one.cell.source for one in cells))).split())
