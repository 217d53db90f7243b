"""Names for cells: stable, readable, and never drawn at random.

A name must survive a corrected typo, because nbgrader matches a submission's cells by name and refuses to
change the names of an assignment that has submissions. So a name comes from what the cell is about, not from
its text.
"""

from __future__ import annotations

import ast
import hashlib
import re
from collections import Counter
from dataclasses import dataclass, field

from autograder.masters.magics import python_of

HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*$", re.MULTILINE)
LONGEST = 48
"""Characters kept of a heading; nbformat allows 64 in an id."""


def grade_id_of_exercise(exercise: str) -> str:
    """The grade_id of the check cell of ``exercise``: a dot is not allowed in one."""
    return exercise.replace(".", "-")


def last_heading(markdown: str) -> str | None:
    """The text of the last heading of a Markdown cell, or None."""
    without_code = re.sub(r"^```.*?^```", "", markdown, flags=re.MULTILINE | re.DOTALL)
    headings = HEADING.findall(without_code)
    return headings[-1] if headings else None


def title(master: str) -> str:
    """The first heading in the text of a master: the title of its notebook."""
    found = HEADING.search(master)
    return found[1] if found else ""


def slug(text: str) -> str:
    """``text`` in lower case, with dashes for all that is no letter and no digit."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower())[:LONGEST].strip("-") or "cell"


def defined_names(source: str) -> list[str]:
    """The functions and classes that a code cell defines at its top level, or the Python file that it writes.

    Raises:
        SyntaxError: ``source`` is no Python, though it has to be.
    """
    definitions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node.name for node in ast.parse(python_of(source)).body if isinstance(node, definitions)]


@dataclass
class Numbering:
    """Hands out names that are unique within a notebook: ``talker``, ``talker-2``, ``talker-3``."""

    taken: Counter[str] = field(default_factory=Counter)

    def name(self, wanted: str) -> str:
        """``wanted``, with a number behind it from the second time on."""
        self.taken[wanted] += 1
        return wanted if self.taken[wanted] == 1 else f"{wanted}-{self.taken[wanted]}"


def text_id(source: str) -> str:
    """An id for a Markdown cell, which nothing but its text can name."""
    return "text-" + hashlib.sha256(source.encode()).hexdigest()[:10]
