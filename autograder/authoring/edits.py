"""Texts that are stored as their changes to another text, the base.

The format is that of a diff without line numbers::

         self.publisher = self.create_publisher(String, 'chatter', 10)
    -        self.i = 0
    +        self.i = 1
    ...
    -        self.i += 1
    +        self.i += 2

A line that begins with ``-`` is removed from the base, and one with ``+`` is added. A line that begins with a space
is in the base and stays; it identifies the place if the other lines occur several times. An empty line is an empty
line that stays. ``...`` separates two places.

A workspace is stored as its changes to a base that all answers to an exercise share. The first line says what the
answer shows. After it come sections:

    === src/my_robot_pkg/setup.py              the whole file, up to the next section
    === src/my_robot_pkg/setup.py (changed)    what is changed in it, in the form above
    === src/my_robot_pkg/setup.py (removed)
    === src/my_robot_pkg -> src/robot          a folder or file under another name
"""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import shutil
from pathlib import Path

SEPARATOR = "..."
"""The line that separates two places of a change."""


class CannotEdit(ValueError):
    """A change does not fit its base. The message names the lines, and says what to do."""


def edited(base: str, change: str) -> str:
    """Return a text after applying a change.

    Args:
        base: The original text.
        change: The changes, in the format above.

    Raises:
        CannotEdit: Lines of the change occur in the base not at all, or several times; or the text is not a change.
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
    """Return the lines of one place, before and after the change."""
    old, new = [], []
    for line in block.split("\n"):
        if line[:1] not in ("", " ", "-", "+"):
            raise CannotEdit(f"{line!r} begins with neither -, + nor a space")
        if line[:1] != "+":
            old.append(line[1:])
        if line[:1] != "-":
            new.append(line[1:])
    if old == new:
        raise CannotEdit(
            f"nothing is changed by {block!r}: put - in front of what goes and + in front of what comes"
        )
    if not old:
        raise CannotEdit(
            f"the place of {block!r} is unknown: add the unchanged line before or after it, with a space in front"
        )
    return old, new


def _place(lines: list[str], old: list[str]) -> int:
    """Return the index of the only place at which these lines occur."""
    found = [at for at in range(len(lines) - len(old) + 1) if lines[at : at + len(old)] == old]
    if len(found) == 1:
        return found[0]
    text = "\n".join(old)
    if found:
        numbers = ", ".join(str(at + 1) for at in found)
        raise CannotEdit(
            f"{text!r} stands in the base {len(found)} times (lines {numbers}): add the line before or after it, "
            "with a space in front"
        )
    missing = next((line for line in old if line not in lines), None)
    if missing is not None:
        raise CannotEdit(f"{missing!r} is not a line of the base")
    raise CannotEdit(f"each line of {text!r} is in the base, but they do not follow each other there")


_SECTION = re.compile(r"^=== (?P<path>\S+)(?: -> (?P<to>\S+)| \((?P<what>changed|removed)\))?$")


def unpack(answer: str, base: Path, folder: Path) -> None:
    """Write the workspace that an answer describes.

    Args:
        answer: The text of the answer.
        base: The workspace that it changes.
        folder: The folder of the new workspace.

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
