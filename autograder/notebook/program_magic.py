"""The cell magics ``%%program`` and ``%%writefile``; ``%%program`` also copies definitions from the notebook.

A line such as ``# copied from this notebook: TalkerNode`` is replaced by the newest definition of ``TalkerNode`` in the
cells that have run, together with the imports and helpers that it uses. After changing the class, a student just runs
its cell and the ``%%program`` cell again.

Both leave a file alone that has the text already, because `colcon` and a check count a file that is written again as
changed since the last build. On a full disk, the file stays as it was.
"""

from __future__ import annotations

import ast
import re  # noqa: TID251  (a student's own cells, in the student's kernel)
import shlex
from pathlib import Path
from typing import Any

from autograder.notebook.cell_output import notebook_shell
from autograder.safe_files import write_whole

_COPIED = re.compile(r"^# copied from this notebook: (?P<names>\w+(?:, \w+)*)$", re.MULTILINE)
_IMPORTS = (ast.Import, ast.ImportFrom)


class NotWrittenError(Exception):
    """The file is as it was before. The message says why."""

    def _render_traceback_(self) -> list[str]:
        """Return the message only, because a traceback would not help. IPython calls this."""
        return [f"Nothing was written. {self}"]


class NotRunError(NotWrittenError):
    """No cell that has run defines the name."""


def program(line: str, cell: str) -> None:
    """Write a cell to a file, with definitions from the notebook. IPython calls this for ``%%program PATH``.

    IPython also calls it for ``%%writefile PATH``, and for ``%%writefile -a PATH``, which appends the cell to the file.

    Raises:
        NotRunError: No cell that has run in this kernel defines one of the names.
        OSError: The file cannot be written.
    """
    *appends, name = shlex.split(line)
    shell: Any = notebook_shell()
    text = with_definitions(cell, [source for source in shell.user_ns.get("In", ()) if source])
    path = Path(name).expanduser()
    _write(path, path.read_text(encoding="utf-8") + text if appends and path.exists() else text)


def _write(path: Path, text: str) -> None:
    data, mode = text.encode(), path.stat().st_mode if path.exists() else None
    if path.is_file() and path.read_bytes() == data:
        print("Unchanged", path)
        return
    print("Overwriting" if path.exists() else "Writing", path)
    path.parent.stat()  # an error if there is no such folder, which would be made
    try:
        write_whole(path.resolve(), data)
    except OSError as error:
        raise NotWrittenError(f"{path} cannot be written: {error.strerror}.") from error
    if mode is not None:
        path.chmod(mode)


def with_definitions(text: str, cells: list[str]) -> str:
    """Return the text of a program in which each comment ``# copied from …`` is replaced by the definitions it names.

    Args:
        text: The text of the cell, without the line of the magic.
        cells: The cells that have run, the oldest first.

    Raises:
        NotRunError: One of the names is not defined in any of the cells.
    """
    defined = {name for node, _ in _statements(_COPIED.sub("", text)) for name in _names(node)}
    imports: list[str] = []

    def copied(comment: re.Match[str]) -> str:
        found = [one for name in comment["names"].split(", ") for one in _definition(name, cells, defined)]
        imports.extend(source for node, source in found if isinstance(node, _IMPORTS))
        return "\n\n\n".join(source for node, source in found if not isinstance(node, _IMPORTS))

    text = _COPIED.sub(copied, text)
    if not imports:
        return text
    first = next((node.lineno for node in ast.parse(text).body if isinstance(node, _IMPORTS)), 1)
    lines = text.split("\n")
    return "\n".join([*lines[: first - 1], *imports, *lines[first - 1 :]])


_Statement = tuple[ast.stmt, str]
"""A statement at the top level of a cell: its syntax tree and its text."""


def _definition(name: str, cells: list[str], defined: set[str]) -> list[_Statement]:
    """Return the newest definition of a name, and before it the imports and helpers that it uses.

    Args:
        cells: The texts of the cells that have run, the oldest first.
        defined: The names that the program defines already. The names of the returned statements are added.
    """
    for source in reversed(cells):
        statements = _statements(source)
        found = next(
            (one for one in reversed(statements) if name in _names(one[0]) - _imported(one[0])), None
        )
        if found is not None:
            break
    else:
        raise NotRunError(f"Run the cell that defines {name} first, then run this one again.")
    defined.add(name)
    return _with_helpers(found, statements, cells, defined)


def _with_helpers(
    found: _Statement, around: list[_Statement], cells: list[str], defined: set[str]
) -> list[_Statement]:
    """Return a statement, and before it the imports and helpers that it uses.

    Args:
        around: All statements of the same cell.
        cells: The texts of the cells that have run, the oldest first.
        defined: As in :func:`_definition`.
    """
    needed: list[_Statement] = []
    own_names = _stored(found[0])
    for used in sorted(_used(found[0]) - defined):
        helper, its_cell = _helper(used, around, cells if used not in own_names else [])
        if helper is None or used in defined:
            continue
        defined |= _names(helper[0])
        needed += (
            [helper] if isinstance(helper[0], _IMPORTS) else _with_helpers(helper, its_cell, cells, defined)
        )
    return [*needed, found]


def _helper(
    name: str, around: list[_Statement], cells: list[str]
) -> tuple[_Statement | None, list[_Statement]]:
    """Return the statement that defines a name, and the statements of its cell; None if no cell defines the name.

    From other cells, only an import, a class, a function or a constant is copied, because a variable there may be a
    node that the student has tried out.
    """
    for one in reversed(around):
        if name in _names(one[0]):
            return one, around
    for statements in map(_statements, reversed(cells)):
        for one in reversed(statements):
            if name in _names(one[0]) and _may_be_copied(one[0]):
                return one, statements
    return None, []


def _may_be_copied(node: ast.stmt) -> bool:
    if not isinstance(node, (ast.Assign, ast.AnnAssign)):
        return True
    try:
        ast.literal_eval(node.value or ast.Constant(None))
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False
    return True


def _statements(source: str) -> list[_Statement]:
    """Return the statements at the top level of a cell; none if Python cannot parse the cell, such as a magic."""
    try:
        body = ast.parse(source).body
    except (SyntaxError, ValueError):
        return []
    lines = source.split("\n")
    return [(node, "\n".join(lines[_first_line(node) - 1 : node.end_lineno])) for node in body]


def _first_line(node: ast.stmt) -> int:
    decorators = getattr(node, "decorator_list", ())
    return min([node.lineno, *(one.lineno for one in decorators)])


def _imported(node: ast.stmt) -> set[str]:
    if not isinstance(node, _IMPORTS):
        return set()
    return {alias.asname or alias.name.partition(".")[0] for alias in node.names}


def _names(node: ast.stmt) -> set[str]:
    """Return the names that a statement defines, by a class, a function, an import or an assignment."""
    if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
        return {node.name}
    if isinstance(node, ast.Assign):
        return {target.id for target in node.targets if isinstance(target, ast.Name)}
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return {node.target.id}
    return _imported(node)


def _used(node: ast.stmt) -> set[str]:
    return {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Load)}


def _stored(node: ast.stmt) -> set[str]:
    """Return the names of the variables and arguments inside a statement. A helper elsewhere may have the same name."""
    arguments = {one.arg for one in ast.walk(node) if isinstance(one, ast.arg)}
    return arguments | {
        one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }


def load_ipython_extension(shell: Any) -> None:
    """Define the magics ``%%program`` and ``%%writefile``.

    In a grader's kernel, this module is imported before IPython's shell exists. So IPython calls this function later,
    when it loads its extensions.
    """
    for name in ("program", "writefile"):
        shell.register_magic_function(program, "cell", name)


if notebook_shell() is not None:
    load_ipython_extension(notebook_shell())
