"""Cells that only show something: left out while a class is graded, because no grade can depend on them.

A chapter shows the ``ros2`` command at work in some forty cells. Each starts processes that take half a second, and all
of them together take longer than everything that a student wrote and the judge looks at. A check runs its subject on a
domain of its own, so that nothing of such a cell reaches it.

A cell counts as a demonstration only where that is plain: it is the master's own, locked and without points,
it is a terminal's (``%%bash``), and each of its commands looks, talks to running nodes or waits. Whatever makes or
changes a file that is not its own log, such as ``ros2 pkg create`` or ``colcon build``, is run, unless it is below
the last cell that earns points. There a notebook has its nodes written into a package, built and run as programs, which
its reader sees and no check looks at: its files and terminals are left out.
"""

from __future__ import annotations

import functools
import re  # noqa: TID251  (a master's cells)
from typing import TYPE_CHECKING, Any

from autograder.boxes.execution import CellType

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory

LEFT_OUT = "[a demonstration of the notebook: left out while grading]"

_LOOKING = frozenset(
    {"ros2", "echo", "which", "ls", "find", "sort", "cat", "grep", "head", "tail", "timeout", "kill", "wait"}
    | {"sleep", "source", ".", "cd", "for", "do", "done", "until", "while", "break", "if", "then", "fi"}
)
"""The beginnings of commands."""
_MAKING = frozenset({("pkg", "create"), ("bag", "record"), ("param", "dump")})
"""The ``ros2`` commands that leave something behind."""
_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'|\{\w+\.\.\w+\}")
_TO_FILE = re.compile(r">>?\s*(?![&\s])([^\s;&|]+)")
_SEPARATORS = re.compile(r"\|\||&&|[;|&\n{}()]")
_REDIRECTIONS = re.compile(r"\d?>>?\s*&?\s*[^\s;&|]+|\d?<\s*[^\s;&|]+")
_FLAGS = re.compile(r"^(?:-\S+|\d+(?:\.\d+)?|INT|!)$")


def is_demonstration(cell: NotebookNode) -> bool:
    """True if a cell of a rebuilt notebook only shows something.

    Args:
        cell: Of a rebuilt notebook, in which only the master's own cells carry nbgrader's marks.
    """
    marks = _marks(cell)
    if (
        cell.cell_type != CellType.CODE
        or not marks.get("locked")
        or marks.get("solution")
        or marks.get("grade")
    ):
        return False
    head, _, script = cell.source.partition("\n")
    return head.split()[:1] == ["%%bash"] and _only_looks(script)


def demonstrations_of(notebook: NotebookNode) -> frozenset[int]:
    """The places of the cells that no grade depends on.

    Args:
        notebook: A rebuilt notebook.
    """
    earning = [place for place, cell in enumerate(notebook.cells) if _marks(cell).get("grade")]
    last = max(earning, default=len(notebook.cells))
    return frozenset(
        place
        for place, cell in enumerate(notebook.cells)
        if is_demonstration(cell) or (place > last and _is_file_or_terminal(cell))
    )


def _marks(cell: NotebookNode) -> dict[str, Any]:
    marks: dict[str, Any] = cell.metadata.get("nbgrader", {})
    return marks


def _is_file_or_terminal(cell: NotebookNode) -> bool:
    head = cell.source.partition("\n")[0].split()[:1]
    return cell.cell_type == CellType.CODE and bool(_marks(cell)) and head in (["%%bash"], ["%%writefile"])


def are_run(directory: ClassDirectory) -> bool:
    """True if the configuration of a class asks for demonstrations to be run."""
    return bool(directory.config.WireExecute.get("demonstrations", False))


@functools.lru_cache(maxsize=256)  # a chapter has some forty, the same for every student
def _only_looks(script: str) -> bool:
    plain = _QUOTED.sub("TEXT", re.sub(r"^\s*#.*$", "", script, flags=re.MULTILINE))
    written = {name for name in _TO_FILE.findall(plain) if name != "/dev/null"}
    if any(not name.endswith(".log") for name in written) or "`" in plain or "$(" in plain:
        return False
    commands = (
        part.split() for part in _SEPARATORS.split(_REDIRECTIONS.sub(" ", plain.replace("\\\n", " ")))
    )
    return all(_looks(words) for words in commands)


def _looks(words: list[str]) -> bool:
    """True if one simple command only looks; keywords and ``timeout`` are before the command they lead to."""
    while words and (
        words[0] in {"do", "then", "until", "while", "if", "timeout", "!"} or _FLAGS.match(words[0])
    ):
        words = words[1:]
    if not words:
        return True
    if words[0] == "ros2":
        return tuple(words[1:3]) not in _MAKING
    return words[0] in _LOOKING and not (words[0] == "find" and {"-delete", "-exec"} & set(words))
