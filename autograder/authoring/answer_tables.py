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

``shows`` is the first line of the resulting program; by default ``Wrong: `` followed by ``why``.

``change`` is an edit. It looks like a diff without line numbers::

         self.publisher = self.create_publisher(String, 'chatter', 10)
    -        self.i = 0
    +        self.i = 1
    ...
    -        self.i += 1
    +        self.i += 2

Lines with ``-`` are removed from the base, and lines with ``+`` are added. A line with a space, or an empty line, stays
unchanged; it identifies the place if the removed lines occur several times. ``...`` separates two places of the base.

The edit of a workspace begins with a line that says what the answer shows. Then follows a section for each changed file
or folder:

    === src/my_robot_pkg/setup.py              the whole file, up to the next section
    === src/my_robot_pkg/setup.py (changed)    the edit of the file, as above
    === src/my_robot_pkg/setup.py (removed)
    === src/my_robot_pkg -> src/robot          a renamed folder or file
"""

from __future__ import annotations

import difflib
import re  # noqa: TID251  (not what a student handed in)
import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import msgspec

from autograder.authoring.author_texts import author_text

if TYPE_CHECKING:
    from collections.abc import Iterator


T = TypeVar("T")
ANSWER_KINDS = ("right", "wrong")
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
        card: If the answer is to be recorded next to the solution: what the card of a node that does the same says.
        next_step: The next step on that card.
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
    card: str = ""
    next_step: str = ""
    command: tuple[str, ...] = ()
    base: str = ""
    shows: str = ""
    change: str = ""


class AnswerSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The settings for all answers of a folder, from its file ``settings.toml``, if it exists.

    Attributes:
        command: The command that runs an answer, with placeholders ``{file}`` and ``{workspace}``.
        base: The workspace of all answers, as a path relative to the folder: an answer named ``*.workspace`` edits it,
            and next to any other one, such as a launch file, it is as it is.
        accepts: The mutants of the solution that may pass, by their keys, as ``try-exercise`` prints them, each with
            the reason. A key may end with ``*``, for all mutants of an operator.
    """

    command: tuple[str, ...] = ("python3", "{file}")
    base: str = ""
    accepts: dict[str, str] = {}


@dataclass(frozen=True)
class ListedAnswer:
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
        return self.file.parents[1] / ANSWER_KINDS[0] / self.entry.base if self.entry.base else None

    def text(self) -> str:
        """Return the text of the program. For a changed workspace, return what is wrong with it, and the change.

        Raises:
            BadTable: The edit does not fit the base.
        """
        if not self.entry.change:
            return self.file.read_text(encoding="utf-8")
        shows = self.entry.shows or f"{self.file.parent.name.capitalize()}: {self.entry.why}"
        if self.base is None:
            return f"{shows}\n{self.entry.change}"
        try:
            text = self.base.read_text(encoding="utf-8")
        except FileNotFoundError:
            existing = sorted(file.name for file in self.base.parent.glob("*.*"))
            similar = difflib.get_close_matches(self.base.name, existing, 1)
            hint = f"did you mean {similar[0]}?" if similar else f"there are {', '.join(existing)}"
            raise self.bad("no_base", folder=self.base.parent, base=self.base.name, hint=hint) from None
        try:
            changed = edited_text(text, self.entry.change)
        except CannotEdit as error:
            raise self.bad("other_base", base=self.base.name, error=error) from None
        if not text.startswith(("#", '"""')):
            # The base begins with code, not with a comment to replace.
            return f"# {shows}\n{changed}"
        _, _, rest = changed.partition("\n")
        return (f"# {shows}" if text.startswith("#") else f'"""{shows}"""') + f"\n{rest}"

    def bad(self, what: str, /, **words: object) -> BadTable:
        """Return the error for this entry of the table."""
        return BadTable(f"{self.table}: {self.file.name}: {author_text(what, **words)}")


def listed_answers(folder: Path) -> Iterator[ListedAnswer]:
    """Yield every answer of a folder, in the order of its tables.

    Args:
        folder: A folder that contains the folders ``right`` and ``wrong``.

    Raises:
        BadTable: A table cannot be read; or an entry is listed twice, lacks a needed field, or has a forbidden one.
    """
    names = set()
    for kind in ANSWER_KINDS:
        for table in sorted((folder / kind).glob("*.toml")):
            for name, entry in _read_table(table, dict[str, AnswerEntry]).items():
                answer = ListedAnswer(folder / kind / name, entry, table)
                _refuse_unusable(answer, twice=answer.file in names)
                names.add(answer.file)
                yield answer


def _refuse_unusable(answer: ListedAnswer, *, twice: bool) -> None:
    file, entry = answer.file, answer.entry
    workspace = file.suffix == WORKSPACE
    needed = (entry.change,) if workspace else (entry.base, entry.change)
    given = (entry.base, entry.shows, entry.change)
    is_right = file.parent.name == ANSWER_KINDS[0]
    troubles = {
        "listed_twice": twice,
        "no_diagnosis": not is_right and not entry.diagnosis,
        "a_diagnosis": is_right and (entry.diagnosis or entry.also),
        "half_an_edit": any(given) and not all(needed),
        "second_base": workspace and entry.base,
        "edit_and_file": any(given) and file.exists(),
        "no_edit_no_file": not any(given) and not file.exists(),
    }
    for what, holds in troubles.items():
        if holds:
            raise answer.bad(what, file=file)


def answer_settings(folder: Path) -> AnswerSettings:
    """Return the settings for all answers of a folder.

    Raises:
        BadTable: The file cannot be used.
    """
    file = folder / "settings.toml"
    return _read_table(file, AnswerSettings) if file.exists() else AnswerSettings()


def _read_table(table: Path, kind: type[T]) -> T:
    try:
        return msgspec.convert(tomllib.loads(table.read_text(encoding="utf-8")), kind)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise BadTable(f"{table}: {error}") from None


_BETWEEN_PLACES = "..."
"""The line in an edit that separates two places of the base."""


class CannotEdit(ValueError):
    """An edit does not fit its base. The message names the lines of the edit, and says what to do."""


def edited_text(base: str, change: str) -> str:
    """Return the base after applying an edit.

    Args:
        base: The original text.
        change: The edit, in the format that this module describes.

    Raises:
        CannotEdit: A place of the edit occurs in the base not at all, or several times; or ``change`` is not an
            edit.
    """
    lines = base.split("\n")
    changes = []
    for part in change.removesuffix("\n").split(f"\n{_BETWEEN_PLACES}\n"):
        old, new = _before_and_after(part)
        changes.append((_only_index(lines, old), old, new))
    changes.sort(key=lambda one: one[0], reverse=True)
    end = len(lines)
    for at, old, new in changes:
        if at + len(old) > end:
            raise CannotEdit(author_text("shared_line", line=lines[end]))
        lines[at : at + len(old)] = new
        end = at
    return "\n".join(lines)


def _before_and_after(part: str) -> tuple[list[str], list[str]]:
    """Return the lines of one place of the base, before and after the edit."""
    old, new = [], []
    for line in part.split("\n"):
        if line[:1] not in ("", " ", "-", "+"):
            raise CannotEdit(author_text("other_beginning", line=line))
        if line[:1] != "+":
            old.append(line[1:])
        if line[:1] != "-":
            new.append(line[1:])
    if old == new:
        raise CannotEdit(author_text("no_change", part=part))
    if not old:
        raise CannotEdit(author_text("no_place", part=part))
    return old, new


def _only_index(lines: list[str], old: list[str]) -> int:
    """Return the index of the only place in ``lines`` at which the lines ``old`` occur."""
    found = [at for at in range(len(lines) - len(old) + 1) if lines[at : at + len(old)] == old]
    if len(found) == 1:
        return found[0]
    text = "\n".join(old)
    if found:
        numbers = ", ".join(str(at + 1) for at in found)
        raise CannotEdit(author_text("several_places", text=text, count=len(found), numbers=numbers))
    missing = next((line for line in old if line not in lines), None)
    if missing is not None:
        raise CannotEdit(author_text("no_line", line=missing))
    raise CannotEdit(author_text("apart", text=text))


_SECTION = re.compile(r"^=== (?P<path>\S+)(?: -> (?P<to>\S+)| \((?P<what>changed|removed)\))?$")


def unpack_workspace(answer: str, base: Path, folder: Path) -> None:
    """Copy the base workspace into a new folder and apply an answer's edit there.

    Args:
        answer: The first line and the edit, in the format that this module describes.
        base: The workspace to copy.
        folder: The new folder.

    Raises:
        CannotEdit: A section of the answer does not fit the base.
    """
    shutil.copytree(base, folder)
    path, to, what, body = Path(), None, None, list[str]()
    for line in [*answer.splitlines()[1:], "=== ."]:
        found = _SECTION.match(line)
        if found is None:
            body.append(line)
            continue
        if path != Path():
            _apply(folder / path, folder / to if to else None, what, body)
        path, to, what, body = Path(found["path"]), found["to"], found["what"], []


def _apply(file: Path, to: Path | None, what: str | None, body: list[str]) -> None:
    if to is not None:
        file.rename(to)
    elif what == "removed":
        shutil.rmtree(file) if file.is_dir() else file.unlink()
    elif what == "changed":
        try:
            file.write_text(edited_text(file.read_text(encoding="utf-8"), "\n".join(body)), encoding="utf-8")
        except CannotEdit as error:
            raise CannotEdit(f"{file}: {error}") from None
    else:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(body).strip("\n") + "\n" if any(body) else "", encoding="utf-8")
