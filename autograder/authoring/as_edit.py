"""``python -m autograder.authoring.as_edit FILE``: a whole answer as an edit of the right answer that is nearest to it.

Prints its entry for a table in ``right`` or ``wrong``. The file can be removed when the entry is there.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from autograder.authoring.answer_tables import Entry, listed, usual_first_line
from autograder.authoring.edits import SEPARATOR, edited

if TYPE_CHECKING:
    from collections.abc import Iterable

Place: TypeAlias = tuple[int, int, int, int]
"""A range of lines that differ: the first and the one after the last in the one text, then in the other."""
NEAR = 10
"""Lines in which an answer may differ from a right one and be stored as an edit of it."""


@dataclass(frozen=True)
class Near:
    """A right answer and what another one changes in it.

    Attributes:
        base: The right answer's file.
        lines: How many lines are changed, added or removed.
        change: The change, as ``autograder.authoring.edits`` reads it.
    """

    base: Path
    lines: int
    change: str


def nearest(text: str, bases: Iterable[Path]) -> Near | None:
    """The base from which the fewest lines have to be changed; None where there is none.

    Args:
        text: The program; its first line, which says what it shows, does not count.
        bases: Right answers that are whole.
    """
    compared = []
    for base in bases:
        first, *there = base.read_text(encoding="utf-8").split("\n")
        own_first, *here = text.split("\n")
        if first[:1] == own_first[:1]:
            compared.append((distance(there, here), base))
    if not compared:
        return None
    lines, base = min(compared)
    return Near(base, lines, change_between(base.read_text(encoding="utf-8"), text))


def distance(old: list[str], new: list[str]) -> int:
    """The number of lines that are changed, added or removed."""
    return sum(max(i2 - i1, j2 - j1) for i1, i2, j1, j2 in _differences(old, new))


def _differences(old: list[str], new: list[str]) -> list[Place]:
    codes = SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    return [places for tag, *places in codes if tag != "equal"]  # type: ignore[misc]


def change_between(base: str, text: str) -> str:
    """The change that makes one text of another; first lines are not compared."""
    old, new = base.split("\n")[1:], text.split("\n")[1:]
    places = _joined(old, _differences(old, new))
    # Lines around a place are added until it can be told from all others.
    while vague := [place for place in places if not _is_clear(base.split("\n"), old, place)]:
        places[places.index(vague[0])] = _wider(old, vague[0])
        places = _joined(old, places)
    change = f"\n{SEPARATOR}\n".join(_block(old, new, place) for place in places) + "\n"
    assert edited(base, change).split("\n")[1:] == new
    return change


def _joined(old: list[str], places: list[Place]) -> list[Place]:
    """Places with at most one line, or nothing but empty ones, between them are one place."""
    joined: list[Place] = []
    for place in places:
        if joined:
            between = old[joined[-1][1] : place[0]]
            if len(between) <= 1 or not any(between):
                joined[-1] = (joined[-1][0], place[1], joined[-1][2], place[3])
                continue
        joined.append(place)
    return joined


def _is_clear(base: list[str], old: list[str], place: Place) -> bool:
    lines = old[place[0] : place[1]]
    return bool(lines) and sum(base[at : at + len(lines)] == lines for at in range(len(base))) == 1


def _wider(old: list[str], place: Place) -> Place:
    """One more line that stays: the one before, unless it is empty and the one after is not."""
    i1, i2, j1, j2 = place
    before, after = i1 > 0, i2 < len(old) - 1
    if before and (old[i1 - 1] or not (after and old[i2])):
        return i1 - 1, i2, j1 - 1, j2
    return i1, i2 + 1, j1, j2 + 1


def _block(old: list[str], new: list[str], place: Place) -> str:
    i1, i2, j1, j2 = place
    lines = []
    for tag, a1, a2, b1, b2 in SequenceMatcher(None, old[i1:i2], new[j1:j2], autojunk=False).get_opcodes():
        if tag == "equal":
            lines += [f" {line}" if line else "" for line in old[i1 + a1 : i1 + a2]]
        else:
            lines += [f"-{line}" for line in old[i1 + a1 : i1 + a2]]
            lines += [f"+{line}" for line in new[j1 + b1 : j1 + b2]]
    return "\n".join(lines)


def toml_string(text: str) -> str:
    """A text of one line as TOML has it, without escapes where that can be."""
    if ('"' in text or "\\" in text) and "'" not in text:
        return f"'{text}'"
    return json.dumps(text, ensure_ascii=False)


def entry(file: Path, text: str, near: Near, said: Entry) -> str:
    """An answer's lines for the table.

    Args:
        file: The answer, in a folder ``right`` or ``wrong``.
        text: The program.
        near: The right answer that it changes.
        said: What is said of it.
    """
    shows = text.split("\n", 1)[0].removeprefix("# ").removeprefix('"""').removesuffix('"""')
    lines = [f'["{file.name}"]']
    if file.parent.name == "wrong":
        lines.append(f'diagnosis = "{said.diagnosis}"')
    lines += [
        f"{name} = {_toml_list(texts)}" for name in ("also", "command") if (texts := getattr(said, name))
    ]
    lines += [f"why = {toml_string(said.why)}", f'base = "{near.base.name}"']
    if shows != usual_first_line(file.parent.name, said.why):
        lines.append(f"shows = {toml_string(shows)}")
    return "\n".join([*lines, "change = '''", f"{near.change}'''", ""])


def _toml_list(texts: Iterable[str]) -> str:
    return f"[{', '.join(map(toml_string, texts))}]"


def worth(text: str, near: Near) -> bool:
    """True if an answer is better stored as an edit than whole: it says less, and shows what is different."""
    return near.lines <= min(NEAR, text.count("\n") // 2)


def whole_right_answers(folder: Path) -> list[Path]:
    """The programs that edits may change, of a folder with the folders ``right`` and ``wrong``."""
    return sorted((folder / "right").glob("*.py"))


def main(words: list[str]) -> int:
    """Print the entries of programs."""
    parser = argparse.ArgumentParser(prog="python -m autograder.authoring.as_edit", description=__doc__)
    parser.add_argument(
        "file", nargs="+", type=Path, help="such as solutions/.../talker.answers/wrong/crashed.py"
    )
    for file in parser.parse_args(words).file:
        folder = file.resolve().parents[1]
        bases = [base for base in whole_right_answers(folder) if base != file.resolve()]
        text = file.read_text(encoding="utf-8")
        near = nearest(text, bases)
        if near is None:
            print(f"{file}: there is no right answer that it could change", file=sys.stderr)
            return 1
        if not worth(text, near):
            print(
                f"{file}: {near.lines} lines differ from {near.base.name}, the nearest: keep it whole",
                file=sys.stderr,
            )
        said = {answer.file: answer.entry for answer in listed(folder)}
        print(entry(file.resolve(), text, near, said.get(file.resolve(), Entry(why=""))))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
