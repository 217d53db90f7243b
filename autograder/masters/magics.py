"""Cells that begin with one of IPython's cell magics: they write a file, or run in a shell.

A workspace of ROS is made of files, so what a student writes in one may be a file instead of a definition::

    %%writefile ros2_ws/src/my_robot_pkg/my_robot_pkg/simple_node.py
    import rclpy
    ...
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import PurePosixPath

MAGIC = re.compile(r"%%(?P<name>\w+)[ \t]*(?P<rest>.*)")


@dataclass(frozen=True)
class WrittenFile:
    """The file that a ``%%writefile`` cell writes.

    Attributes:
        path: Where, relative to the notebook.
        text: The file's text, without the line of the magic.
    """

    path: PurePosixPath
    text: str

    @property
    def is_python(self) -> bool:
        """True if the text has to be Python."""
        return self.path.suffix == ".py"


def has_magic(source: str) -> bool:
    """True if the cell is given to a magic instead of to Python."""
    return MAGIC.match(source) is not None


def written_file(source: str) -> WrittenFile | None:
    """The file that a cell writes, or None for any other cell."""
    magic = MAGIC.match(source)
    if magic is None or magic["name"] != "writefile":
        return None
    words = shlex.split(magic["rest"])
    if len(words) != 1:
        return None
    return WrittenFile(PurePosixPath(words[0]), source.partition("\n")[2])


def shell_script(source: str) -> str | None:
    """The text that a ``%%bash`` cell gives to the shell, or None for any other cell."""
    magic = MAGIC.match(source)
    if magic is None or magic["name"] != "bash":
        return None
    return source.partition("\n")[2]


def python_of(source: str) -> str:
    """The part of a cell that has to be Python, with as many lines: empty where none of it has to."""
    if not has_magic(source):
        return source
    file = written_file(source)
    return f"\n{file.text}" if file is not None and file.is_python else ""
