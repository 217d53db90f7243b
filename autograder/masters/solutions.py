"""The reference solution of each exercise as students may read it once they have full marks: code, and why it is so.

Why is beside the exercise, in a file such as ``talker.why.md``: one paragraph, and where another way is worth a
look, the heading ``## Another way``, a paragraph and a block of code. The code of the solution is the master's.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from autograder.course import SOLUTION, WHY
from autograder.masters.magics import shell_script
from autograder.masters.master_errors import MasterError
from autograder.masters.parsing import CellRole
from autograder.masters.regions import find_region

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from autograder.masters.source import NamedCell

OTHER_WAY = "## Another way"
LINES = 2
"""Lines that a reason has at most: whoever has solved a task wants to go on."""
WIDTH = 140
"""Characters of a line."""


def solution_files(master: Path, cells: Sequence[NamedCell]) -> dict[Path, str]:
    """For each exercise of a master with a reason beside it: the file to write, and its text.

    Args:
        master: The master.
        cells: Its cells.

    Raises:
        MasterError: A reason has another form.
    """
    return dict(_solution_files(master, cells))


def _solution_files(master: Path, cells: Sequence[NamedCell]) -> Iterator[tuple[Path, str]]:
    code: list[str] = []
    for named in cells:
        # What a student types into a terminal is no part of what is checked.
        if named.cell.kind is CellRole.SOLUTION and shell_script(named.cell.source) is None:
            code.append(_solved(named.cell.source))
        elif named.check is not None:
            exercise = named.check.exercise
            why = master.with_name(f"{exercise.partition('.')[2]}{WHY}")
            if why.is_file():
                yield why.with_name(why.name.removesuffix(WHY) + SOLUTION), _text(exercise, code, why)
            code = []


def _solved(source: str) -> str:
    region = find_region(source)
    return "\n".join((*region.before, *region.answer, *region.after)).strip()


def _text(exercise: str, code: list[str], why: Path) -> str:
    reason, _, other = (part.strip() for part in why.read_text(encoding="utf-8").partition(OTHER_WAY))
    if (
        not reason
        or len(reason.splitlines()) > LINES
        or any(len(line) > WIDTH for line in reason.splitlines())
    ):
        raise MasterError(
            why, 1, f"A reason has one or {LINES} lines.", "Say the one thing that is worth it."
        )
    words, _, rest = other.partition("```python\n")
    example, fence, after = rest.partition("\n```")
    if other and (not words.strip() or not fence or after.strip()):
        raise MasterError(
            why, None, f"'{OTHER_WAY}' has another form.", "Write a paragraph, then one block ```python."
        )
    said = {
        "exercise": exercise,
        "code": code,
        "why": " ".join(reason.split()),
        "other_way": " ".join(words.split()),
        "other_code": example.strip("\n"),
    }
    return json.dumps(said, indent=1, ensure_ascii=False) + "\n"
