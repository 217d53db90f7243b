"""The tables of the bank. They describe each answer, and contain each answer that is stored as an edit.

A folder of answers contains two folders, ``right`` and ``wrong``, with programs and tables (``*.toml``). An entry of
a table is named after the file of its answer::

    "while_loop_sleep.py" = { why = "a loop with time.sleep keeps the rate" }      the file exists

    ["counter_start.py"]                                  no file: the entry changes a file of the folder right
    diagnosis = "counter_start"
    why = "the first text has the number 1"
    base = "usual.py"
    shows = "Wrong: counts from 1."
    change = '''
    -        self.i = 0
    +        self.i = 1
    '''

    ["not_logged.workspace"]                              no file: the entry changes the folder's workspace
    diagnosis = "not_logged"
    why = "nothing in the log"
    change = '''
    === src/my_robot_pkg/my_robot_pkg/simple_node.py (changed)
    -        self.get_logger().info("Hello, ROS 2! From SimpleNode.")
    '''

``shows`` is the first line of the resulting program; by default ``Wrong: `` followed by ``why``. For the format of
``change`` see ``autograder.authoring.edits``.
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
"""An answer whose name ends with this suffix is a workspace, not a single program."""


class BadTable(ValueError):
    """A table of the bank cannot be used. The message names the table, the entry, and what to do."""


class AnswerEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The entry of a table for one answer.

    Attributes:
        why: Why the answer is right, or how its mistake shows.
        diagnosis: The diagnosis that the judge should give, as a key in ``docs/mistakes.md``; empty for a right
            answer.
        also: Other diagnoses that are accepted, as keys.
        says: Words that the answer's card must contain, if the key alone does not identify the mistake.
        command: The command that runs the answer; empty for the usual command of the folder.
        base: The file in the folder ``right`` that the edit changes. Empty for a program in a file of its own, and for
            a workspace, which is an edit of the workspace in ``settings.toml``.
        shows: The first line of the program, without the characters that make it a docstring or comment; if empty,
            ``Wrong: `` or ``Right: `` followed by ``why``.
        change: The edit of the base; empty for a program in a file of its own.
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
    """The settings for all answers of a folder, from its file ``settings.toml``, if it exists.

    Attributes:
        command: The command that runs an answer, with placeholders ``{file}`` and ``{workspace}``.
        base: The workspace that every answer named ``*.workspace`` edits, as a path relative to the folder.
    """

    command: tuple[str, ...] = ("python3", "{file}")
    base: str = ""


@dataclass(frozen=True)
class Listed:
    """An answer together with its entry in a table.

    Attributes:
        file: The program; if it is stored as an edit, the path that the program would have.
        entry: The entry in the table.
        table: The file of the table.
    """

    file: Path
    entry: AnswerEntry
    table: Path

    @property
    def base(self) -> Path | None:
        """The path of the right answer from which an edit makes this answer; None if no edit makes it."""
        return self.file.parents[1] / KINDS[0] / self.entry.base if self.entry.base else None

    def text(self) -> str:
        """Return the text of the program. For a changed workspace, return what is wrong with it, and the change.

        Raises:
            BadTable: The edit does not fit the base.
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
            raise self._bad(
                f"{self.base.parent} has no file {self.base.name}, which is the entry's base; {hint}"
            ) from None
        try:
            changed = edited(text, self.entry.change)
        except CannotEdit as error:
            raise self._bad(f"the edit does not fit {self.base.name}: {error}") from None
        if not text.startswith(("#", '"""')):
            # The base begins with code, not with a comment to replace.
            return f"# {shows}\n{changed}"
        _, _, rest = changed.partition("\n")
        return (f"# {shows}" if text.startswith("#") else f'"""{shows}"""') + f"\n{rest}"

    def _bad(self, what: str) -> BadTable:
        return BadTable(f"{self.table}: {self.file.name}: {what}")


def usual_first_line(kind: str, why: str) -> str:
    """Return the default first line of a program: ``Wrong: `` or ``Right: ``, followed by the reason."""
    return f"{kind.capitalize()}: {why}"


def listed(folder: Path) -> Iterator[Listed]:
    """Yield every answer of a folder, in the order of its tables.

    Args:
        folder: A folder that contains the folders ``right`` and ``wrong``.

    Raises:
        BadTable: A table cannot be read; or an entry is listed twice, lacks a needed field, or has a forbidden one.
    """
    names = set()
    for kind in KINDS:
        for table in sorted((folder / kind).glob("*.toml")):
            for name, entry in _read(table, dict[str, AnswerEntry]).items():
                answer = Listed(folder / kind / name, entry, table)
                _look_at(answer, twice=answer.file in names)
                names.add(answer.file)
                yield answer


def _look_at(answer: Listed, *, twice: bool) -> None:
    file, entry = answer.file, answer.entry
    workspace = file.suffix == WORKSPACE
    needed = (entry.change,) if workspace else (entry.base, entry.change)
    given = (entry.base, entry.shows, entry.change)
    troubles = {
        "the answer is listed twice": twice,
        "a wrong answer needs a diagnosis": file.parent.name != KINDS[0] and not entry.diagnosis,
        "a right answer must not have a diagnosis": file.parent.name == KINDS[0]
        and bool(entry.diagnosis or entry.also),
        "an edit needs the fields base and change": any(given) and not all(needed),
        "remove base: settings.toml sets the base of all workspaces": workspace and bool(entry.base),
        f"the entry is an edit, but the file {file} exists: remove one of the two": any(given)
        and file.exists(),
        f"the file {file} does not exist, and the answer has no base and change": not any(given)
        and not file.exists(),
    }
    for what, holds in troubles.items():
        if holds:
            raise BadTable(f"{answer.table}: {file.name}: {what}")


def settings(folder: Path) -> Settings:
    """Return the settings for all answers of a folder.

    Raises:
        BadTable: The file cannot be used.
    """
    file = folder / "settings.toml"
    return _read(file, Settings) if file.exists() else Settings()


def _read(table: Path, kind: type[T]) -> T:
    try:
        return msgspec.convert(tomllib.loads(table.read_text(encoding="utf-8")), kind)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise BadTable(f"{table}: {error}") from None
