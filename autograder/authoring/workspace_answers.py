"""Workspaces of the bank, each written as one text: what it changes in a base that all of them share.

The first line says what the answer shows. Then come sections:

    === src/my_robot_pkg/setup.py              the whole file, up to the next section
    === src/my_robot_pkg/setup.py (changed)    what is changed in it, in the form of autograder.authoring.edits
    === src/my_robot_pkg/setup.py (removed)
    === src/my_robot_pkg -> src/robot          a folder or file under another name
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from autograder.authoring.edits import CannotEdit, edited

_SECTION = re.compile(r"^=== (?P<path>\S+)(?: -> (?P<to>\S+)| \((?P<what>changed|removed)\))?$")


def unpack(answer: str, base: Path, folder: Path) -> None:
    """Write the workspace of an answer.

    Args:
        answer: The text.
        base: The workspace that it changes.
        folder: The workspace's folder, made here.

    Raises:
        CannotEdit: A section does not fit the base.
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
