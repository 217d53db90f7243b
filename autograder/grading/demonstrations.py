"""Cells that only show something: left out while a class is graded, because no grade can depend on them.

A chapter shows the ``ros2`` command at work in some forty cells. Each starts processes that take half a second, and all
of them together take longer than everything that a student wrote and the judge looks at. A check runs its subject on a
domain of its own, so that nothing of such a cell reaches it.

A cell counts as a demonstration only where that is plain: it is the master's own, locked and without points,
it is a terminal's (``%%bash``), and each of its commands looks, talks to running nodes or waits. Whatever makes or
changes a file that is not its own log, such as ``ros2 pkg create`` or ``colcon build``, is run.
"""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING

from autograder.boxes.execution import Kind

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.class_directory import ClassDirectory

LEFT_OUT = "[a demonstration of the notebook: left out while grading]"

_LOOKING = frozenset(
    {"ros2", "echo", "which", "ls", "find", "sort", "cat", "grep", "head", "tail", "timeout", "kill", "wait"}
    | {"sleep", "source", ".", "cd", "for", "do", "done", "until", "while", "break", "if", "then", "fi"}
)
"""What a command may begin with."""
_MAKING = frozenset({("pkg", "create"), ("bag", "record"), ("param", "dump")})
"""The ``ros2`` commands that leave something behind."""
_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'|\{\w+\.\.\w+\}")
_TO_FILE = re.compile(r">>?\s*(?![&\s])([^\s;&|]+)")
_SEPARATORS = re.compile(r"\|\||&&|[;|&\n{}()]")
_REDIRECTIONS = re.compile(r"\d?>>?\s*&?\s*[^\s;&|]+|\d?<\s*[^\s;&|]+")
_FLAGS = re.compile(r"^(?:-\S+|\d+(?:\.\d+)?|INT|!)$")


def is_demonstration(cell: NotebookNode) -> bool:
    """Whether a cell of a rebuilt notebook only shows something.

    Args:
        cell: Of a rebuilt notebook, in which only the master's own cells carry nbgrader's marks.
    """
    marks = cell.metadata.get("nbgrader", {})
    if cell.cell_type != Kind.CODE or not marks.get("locked") or marks.get("solution") or marks.get("grade"):
        return False
    head, _, script = cell.source.partition("\n")
    return head.split()[:1] == ["%%bash"] and _only_looks(script)


def are_run(directory: ClassDirectory) -> bool:
    """Whether a class wants its demonstrations run all the same."""
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
    """Whether one simple command only looks; keywords and ``timeout`` stand before the command they lead to."""
    while words and (
        words[0] in {"do", "then", "until", "while", "if", "timeout", "!"} or _FLAGS.match(words[0])
    ):
        words = words[1:]
    if not words:
        return True
    if words[0] == "ros2":
        return tuple(words[1:3]) not in _MAKING
    return words[0] in _LOOKING and not (words[0] == "find" and {"-delete", "-exec"} & set(words))
