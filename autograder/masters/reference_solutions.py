"""Extracts the reference solution of each exercise from its master: as a program, and for students to read.

After full marks, students may read the code and the reasons for it. The reasons are in a file next to the exercise,
such as ``talker.why.md``: one paragraph and, if another way is worth showing, the heading ``## Another way``, a
paragraph and a block of code. A repair needs no such file: students see how it changes the broken code.
"""

from __future__ import annotations

import ast
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.course import SOLUTION, WHY
from autograder.masters.check_cells import exercise_points
from autograder.masters.code_cells import find_region, has_magic, shell_script, written_file
from autograder.masters.master_cells import CellRole, MasterCell
from autograder.masters.master_files import MasterError
from autograder.masters.source_notebooks import Points, named_cells

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.masters.source_notebooks import NamedCell


_KEPT = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
"""The kinds of statements that a program takes from a given cell. It also takes constants."""
_OTHER_WAY = "## Another way"
_MAX_LINES = 2
"""The maximum number of lines that explain a solution. They are few, because a student who has solved a task wants to
go on.
"""
_MAX_WIDTH = 140
"""The maximum length of such a line, in characters."""


@dataclass(frozen=True)
class ReferenceSolution:
    """The reference solution of an exercise.

    Attributes:
        source: Python code that makes ``subject``: it defines the class or function, or writes the files into the
            current folder.
        subject: The subject as Python text: the name of the class or function that the check cell judges, or the path
            of the files.
        own: The solution cells of this exercise, as they stand in ``source``: those since the check before.
    """

    source: str
    subject: str
    own: tuple[str, ...] = ()

    def check_cell(self, exercise: str) -> str:
        """Return the code that checks the subject, for a program that does not come from a notebook."""
        begin = "from autograder.notebook import check, start_ros\nstart_ros()"
        return f"{begin}\ncheck({exercise!r}, {self.subject})\n"


def reference_source(
    master: Path, exercise: str, *, points: Points = exercise_points, solved: bool = True
) -> ReferenceSolution:
    """Return a program that defines everything that a notebook defines before the check of ``exercise``.

    If ``solved`` is false, the solution cells are as students get them.

    Solution cells are kept whole. Of given cells, only imports, functions, classes and constants are kept, because
    other code only shows something. The program writes the files of ``%%writefile`` cells. If the subject is a path,
    shell cells are run as well, because commands such as ``ros2 pkg create`` make the files that are judged.

    Raises:
        MasterError: The master cannot be used, or does not check ``exercise``.
    """
    cells: list[MasterCell] = []
    own: list[str] = []
    for named in named_cells(master, points=points):
        if named.check is not None and named.check.exercise == exercise:
            shell = named.check.is_path
            parts = [part for cell in cells for part in _program_parts(cell, shell=shell, solved=solved)]
            return ReferenceSolution("\n\n".join(parts) + "\n", named.check.subject, tuple(own))
        cells.append(named.cell)
        if named.check is not None:
            own.clear()
        elif named.cell.kind is CellRole.SOLUTION:
            own.append(named.cell.source)
    raise MasterError(master, None, "no_check", exercise=exercise)


def _program_parts(cell: MasterCell, *, shell: bool, solved: bool) -> Iterator[str]:
    """Yield the part of one cell that the program needs.

    Args:
        cell: Any cell above the check.
        shell: True to run shell cells.
        solved: False to leave out the solution.
    """
    if cell.kind not in (CellRole.SOLUTION, CellRole.GIVEN):
        return
    is_stub = cell.kind is CellRole.SOLUTION and not solved
    source = find_region(cell.source).unsolved if is_stub else cell.source
    if (file := written_file(source)) is not None:
        yield (
            f"import pathlib\nfile = pathlib.Path({str(file.path)!r})\n"
            f"file.parent.mkdir(parents=True, exist_ok=True)\nfile.write_text({file.text!r})"
        )
    elif (script := shell_script(source)) is not None:
        if shell:
            yield f"import subprocess\nsubprocess.run(['bash', '-c', {script!r}], check=False)"
    elif has_magic(source):
        return  # another magic, which no program needs
    elif cell.kind is CellRole.SOLUTION:
        yield source
    else:
        yield from _definitions(cell)


def _definitions(cell: MasterCell) -> Iterator[str]:
    lines = cell.source.split("\n")
    for node in ast.parse(cell.source).body:
        if isinstance(node, _KEPT) or _is_constant(node):
            decorators = getattr(node, "decorator_list", [])
            first = min([node.lineno, *(decorator.lineno for decorator in decorators)])
            yield "\n".join(lines[first - 1 : node.end_lineno])


def _is_constant(node: ast.stmt) -> bool:
    """Return True if a statement assigns a value and calls nothing. A later definition may need such a constant."""
    if not isinstance(node, (ast.Assign, ast.AnnAssign)):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if not all(isinstance(target, ast.Name) for target in targets):
        return False
    return not any(isinstance(inner, (ast.Call, ast.Await)) for inner in ast.walk(node))


def solution_files(master: Path, cells: Sequence[NamedCell]) -> dict[Path, str]:
    """Return the texts of a master's solution files, by path: one for each repair and each exercise with reasons.

    Raises:
        MasterError: A file with reasons does not have the right form.
    """
    texts = {}
    code: list[str] = []
    broken: list[str] = []
    for named in cells:
        # Leave out shell cells: commands that a student types in a terminal are not part of the checked code.
        if named.cell.kind is CellRole.SOLUTION and shell_script(named.cell.source) is None:
            region = find_region(named.cell.source)
            code.append(region.solved.strip())
            broken.append(region.unsolved.strip() if region.is_repair else "")
        elif named.check is not None:
            exercise = named.check.exercise
            why = master.with_name(f"{exercise.partition('.')[2]}{WHY}")
            file = why.with_name(why.name.removesuffix(WHY) + SOLUTION)
            if why.is_file():
                texts[file] = _solution_text(exercise, code, why)
            elif any(broken):
                texts[file] = _as_json({"exercise": exercise, "code": code, "broken": broken})
            code, broken = [], []
    return texts


def _solution_text(exercise: str, code: list[str], why: Path) -> str:
    reason, _, other = (part.strip() for part in why.read_text(encoding="utf-8").partition(_OTHER_WAY))
    if (
        not reason
        or len(reason.splitlines()) > _MAX_LINES
        or any(len(line) > _MAX_WIDTH for line in reason.splitlines())
    ):
        raise MasterError(why, 1, "long_reason")
    words, _, rest = other.partition("```python\n")
    example, fence, after = rest.partition("\n```")
    if other and (not words.strip() or not fence or after.strip()):
        raise MasterError(why, None, "other_way")
    fields = {
        "exercise": exercise,
        "code": code,
        "why": " ".join(reason.split()),
        "other_way": " ".join(words.split()),
        "other_code": example.strip("\n"),
    }
    return _as_json(fields)


def _as_json(fields: Mapping[str, object]) -> str:
    return json.dumps(fields, indent=1, ensure_ascii=False) + "\n"
