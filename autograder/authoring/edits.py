"""Applies an edit to a base, for example to a right answer, and returns the new text or writes a new workspace.

An edit looks like a diff without line numbers::

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

import re  # noqa: TID251  (not what a student handed in)
import shutil
from pathlib import Path

SEPARATOR = "..."
"""The line in an edit that separates two places of the base."""


class CannotEdit(ValueError):
    """An edit does not fit its base. The message names the lines of the edit, and says what to do."""


def edited(base: str, change: str) -> str:
    """Return the base after applying an edit.

    Args:
        base: The original text.
        change: The edit, in the format that this module describes.

    Raises:
        CannotEdit: A place of the edit occurs in the base not at all, or several times; or ``change`` is not an
            edit.
    """
    lines = base.split("\n")
    places = []
    for block in change.removesuffix("\n").split(f"\n{SEPARATOR}\n"):
        old, new = _sides(block)
        places.append((_place(lines, old), old, new))
    places.sort(key=lambda place: place[0], reverse=True)
    end = len(lines)
    for at, old, new in places:
        if at + len(old) > end:
            raise CannotEdit(f"two places of the change share the line {lines[end]!r}: write them as one")
        lines[at : at + len(old)] = new
        end = at
    return "\n".join(lines)


def _sides(block: str) -> tuple[list[str], list[str]]:
    """Return the lines of one place of the base, before and after the edit."""
    old, new = [], []
    for line in block.split("\n"):
        if line[:1] not in ("", " ", "-", "+"):
            raise CannotEdit(f"{line!r} does not begin with -, + or a space")
        if line[:1] != "+":
            old.append(line[1:])
        if line[:1] != "-":
            new.append(line[1:])
    if old == new:
        raise CannotEdit(
            f"{block!r} changes nothing: put - in front of each line to remove and + in front of each line to add"
        )
    if not old:
        raise CannotEdit(
            f"{block!r} does not say where to add its lines: also write the unchanged line before or after them, "
            "with a space in front"
        )
    return old, new


def _place(lines: list[str], old: list[str]) -> int:
    """Return the index of the only place in ``lines`` at which the lines ``old`` occur."""
    found = [at for at in range(len(lines) - len(old) + 1) if lines[at : at + len(old)] == old]
    if len(found) == 1:
        return found[0]
    text = "\n".join(old)
    if found:
        numbers = ", ".join(str(at + 1) for at in found)
        raise CannotEdit(
            f"{text!r} occurs in the base {len(found)} times (lines {numbers}): add the line before or after it, "
            "with a space in front"
        )
    missing = next((line for line in old if line not in lines), None)
    if missing is not None:
        raise CannotEdit(f"{missing!r} is not a line of the base")
    raise CannotEdit(f"each line of {text!r} is in the base, but there the lines do not follow each other")


_SECTION = re.compile(r"^=== (?P<path>\S+)(?: -> (?P<to>\S+)| \((?P<what>changed|removed)\))?$")


def unpack(answer: str, base: Path, folder: Path) -> None:
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
            file.write_text(edited(file.read_text(encoding="utf-8"), "\n".join(body)), encoding="utf-8")
        except CannotEdit as error:
            raise CannotEdit(f"{file}: {error}") from None
    else:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(body).strip("\n") + "\n" if any(body) else "", encoding="utf-8")
