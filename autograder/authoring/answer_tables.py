"""The tables of the bank: what is said of each answer, and those answers that are stored as edits of a right one.

A folder of answers has two folders, ``right`` and ``wrong``, with programs and tables (``*.toml``). An entry of a
table is named after the file of its answer::

    "while_loop_sleep.py" = { why = "a loop with time.sleep keeps the rate" }      a file of the folder

    ["counter_start.py"]                                  no file: what it changes in a file of the folder right
    diagnosis = "counter_start"
    why = "the first text has the number 1"
    base = "usual.py"
    shows = "Wrong: counts from 1."
    change = '''
    -        self.i = 0
    +        self.i = 1
    '''

    ["not_logged.workspace"]                              what it changes in the workspace of all answers of the folder
    diagnosis = "not_logged"
    why = "nothing in the log"
    change = '''
    === src/my_robot_pkg/my_robot_pkg/simple_node.py (changed)
    -        self.get_logger().info("Hello, ROS 2! From SimpleNode.")
    '''

``shows`` is the first line of its program (it can be left out where that is ``Wrong: `` and ``why``), ``change`` has
the form of ``autograder.authoring.edits``.
"""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import msgspec

from autograder.authoring.edits import CannotEdit, edited

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

T = TypeVar("T")
KINDS = ("right", "wrong")
WORKSPACE = ".workspace"
"""The ending of the name of an answer that is a whole workspace."""


class BadTable(ValueError):
    """A table of the bank cannot be used. The message names the table, the entry, and what to do."""


class Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table's entry on one answer.

    Attributes:
        why: Why it is right, or what is seen of the mistake.
        diagnosis: The most useful key of ``docs/mistakes.md``; empty for a right answer.
        also: Keys that are right, too.
        says: Words that its card must say, where the key alone does not name what to mend.
        command: What runs it, where it is not what runs all of the folder.
        base: The right answer that it changes, a file of the folder ``right``; empty for a whole program and for a
            workspace, which changes that of the folder.
        shows: The first line of its program, without the signs that make it a docstring or a comment; ``Wrong: `` (or
            ``Right: ``) and ``why`` where it is empty.
        change: What it changes in its base.
    """

    why: str
    diagnosis: str = ""
    also: tuple[str, ...] = ()
    says: str = ""
    command: tuple[str, ...] = ()
    base: str = ""
    shows: str = ""
    change: str = ""


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The settings for all answers of a folder: its file ``settings.toml``, where there is one.

    Attributes:
        command: What runs an answer, with places for ``{file}`` and ``{workspace}``.
        base: The workspace that answers in ``*.workspace`` change, as a path from the folder.
    """

    command: tuple[str, ...] = ("python3", "{file}")
    base: str = ""


@dataclass(frozen=True)
class Listed:
    """An answer as its table has it.

    Attributes:
        file: Its program; where it is stored as an edit, the path that it would have.
        entry: What the table says.
        table: The table.
    """

    file: Path
    entry: Entry
    table: Path

    @property
    def base(self) -> Path | None:
        """The right answer that it changes; None for one that is stored whole, and for a workspace."""
        return self.file.parents[1] / KINDS[0] / self.entry.base if self.entry.base else None

    def text(self) -> str:
        """Its program; for a workspace, the text that says what it changes in one.

        Raises:
            BadTable: It is an edit that does not fit its base.
        """
        if not self.entry.change:
            return self.file.read_text(encoding="utf-8")
        shows = self.entry.shows or usual_first_line(self.file.parent.name, self.entry.why)
        if self.base is None:
            return f"{shows}\n{self.entry.change}"
        try:
            text = self.base.read_text(encoding="utf-8")
        except FileNotFoundError:
            there = sorted(file.name for file in self.base.parent.glob("*.*"))
            like = difflib.get_close_matches(self.base.name, there, 1)
            hint = f"did you mean {like[0]}?" if like else f"there are {', '.join(there)}"
            raise self._bad(f"its base {self.base.name} is no file of {self.base.parent}; {hint}") from None
        try:
            changed = edited(text, self.entry.change)
        except CannotEdit as error:
            raise self._bad(f"its change does not fit {self.base.name}: {error}") from None
        if not text.startswith(("#", '"""')):
            return f"# {shows}\n{changed}"  # its base begins with code, which stays
        _, _, rest = changed.partition("\n")
        return (f"# {shows}" if text.startswith("#") else f'"""{shows}"""') + f"\n{rest}"

    def _bad(self, what: str) -> BadTable:
        return BadTable(f"{self.table}: {self.file.name}: {what}")


def usual_first_line(kind: str, why: str) -> str:
    """The first line of a program whose entry names none."""
    return f"{kind.capitalize()}: {why}"


def listed(folder: Path) -> Iterator[Listed]:
    """Every answer of a folder, in the order of its tables.

    Args:
        folder: One with the folders ``right`` and ``wrong``.

    Raises:
        BadTable: A table cannot be read, or an entry says too little, too much, or the same as another one.
    """
    names = set()
    for kind in KINDS:
        for table in sorted((folder / kind).glob("*.toml")):
            for name, entry in _read(table, dict[str, Entry]).items():
                answer = Listed(folder / kind / name, entry, table)
                _look_at(answer, twice=answer.file in names)
                names.add(answer.file)
                yield answer


def _look_at(answer: Listed, *, twice: bool) -> None:
    """Refuse an entry that is no answer."""
    file, entry = answer.file, answer.entry
    workspace = file.suffix == WORKSPACE
    needed = (entry.change,) if workspace else (entry.base, entry.change)
    given = (entry.base, entry.shows, entry.change)
    troubles = {
        "it is listed twice": twice,
        "a wrong answer needs a diagnosis": file.parent.name != KINDS[0] and not entry.diagnosis,
        "a right answer has no diagnosis": file.parent.name == KINDS[0]
        and bool(entry.diagnosis or entry.also),
        "an edit needs base and change": any(given) and not all(needed),
        "a workspace needs no base: it changes that of the folder": workspace and bool(entry.base),
        f"it is an edit, and {file} is there as well: remove one of them": any(given) and file.exists(),
        f"there is no file {file}, and the entry is no edit": not any(given) and not file.exists(),
    }
    for what, holds in troubles.items():
        if holds:
            raise BadTable(f"{answer.table}: {file.name}: {what}")


def settings(folder: Path) -> Settings:
    """The settings for all answers of a folder.

    Raises:
        BadTable: Its file cannot be used.
    """
    file = folder / "settings.toml"
    return _read(file, Settings) if file.exists() else Settings()


def _read(table: Path, kind: type[T]) -> T:
    try:
        return msgspec.convert(tomllib.loads(table.read_text(encoding="utf-8")), kind)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise BadTable(f"{table}: {error}") from None
