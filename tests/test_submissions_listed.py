"""The bank of answers is whole: every program is listed, is there, and has a diagnosis that is explained.

This looks at the data alone; the judging of the bank has a test of its own.
"""

from __future__ import annotations

import ast
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

BANK = Path(__file__).parent / "submissions"
NOTEBOOKS = BANK / "notebooks"
MISTAKES = Path(__file__).parents[1] / "docs" / "mistakes.md"
LISTINGS = sorted(BANK.glob("*/expected.toml"))
CELL = re.compile(r"^# %% (solution \w+|extra)$", re.MULTILINE)


@dataclass(frozen=True)
class Answer:
    """One listed file: where it should be, ``"correct"`` or ``"wrong"``, and what its listing says."""

    path: Path
    kind: str
    entry: dict[str, Any]

    @property
    def source(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @property
    def keys(self) -> set[str]:
        """All diagnoses that are right for it."""
        return {self.entry["diagnosis"], *self.entry.get("also", [])} if "diagnosis" in self.entry else set()


def listed(folder: Path, listing: dict[str, Any]) -> list[Answer]:
    return [
        Answer(folder / kind / name, kind, entry)
        for kind in ("correct", "wrong")
        for name, entry in listing[kind].items()
    ]


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


PROGRAMS = [answer for path in LISTINGS for answer in listed(path.parent, read(path))]
IN_NOTEBOOKS = [
    answer
    for exercise, listing in read(NOTEBOOKS / "notebooks.toml").items()
    for answer in listed(NOTEBOOKS / exercise, listing)
]


def is_python(source: str) -> bool:
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


def explained() -> set[str]:
    return set(re.findall(r"^### `(\w+)`$", MISTAKES.read_text(encoding="utf-8"), re.MULTILINE))


def test_every_file_is_listed_and_every_listed_one_is_there() -> None:
    found = {
        path for path in BANK.rglob("*.*") if path.is_file() and path.parent.name in ("correct", "wrong")
    }
    assert found == {answer.path for answer in PROGRAMS + IN_NOTEBOOKS}


def test_a_program_says_in_its_first_line_what_it_shows() -> None:
    words = {"correct": "Right", "wrong": "Wrong"}
    mute = [
        a.path for a in PROGRAMS if not a.source.splitlines()[0].lstrip("<!-# \"'").startswith(words[a.kind])
    ]
    assert mute == []


def test_only_a_syntax_error_cannot_be_read_by_python() -> None:
    programs = [answer for answer in PROGRAMS if answer.path.suffix == ".py"]
    unreadable = {answer.path for answer in programs if not is_python(answer.source)}
    assert unreadable == {
        answer.path for answer in programs if answer.entry.get("diagnosis") == "syntax_error"
    }


def test_what_fails_has_a_diagnosis_and_what_passes_has_none() -> None:
    assert [a.path for a in PROGRAMS if bool(a.keys) != (a.kind == "wrong")] == []
    assert [a.path for a in IN_NOTEBOOKS if bool(a.keys) != (a.entry["verdict"] == "failed")] == []


def test_every_diagnosis_is_explained_to_students() -> None:
    keys = explained()
    assert {key for answer in PROGRAMS + IN_NOTEBOOKS for key in answer.keys} - keys == set()


def test_a_wrong_program_is_named_after_its_diagnosis() -> None:
    # The course text's own solutions are named so instead.
    names = {
        a.path: a.path.stem for a in PROGRAMS if a.kind == "wrong" and a.path.stem != "text_as_it_stands"
    }
    odd = [a.path for a in PROGRAMS if a.path in names and not names[a.path].startswith(a.entry["diagnosis"])]
    assert odd == []


def test_an_answer_in_a_notebook_names_its_exercise_and_its_cells() -> None:
    for answer in IN_NOTEBOOKS:
        assert answer.source.startswith(f"# {answer.path.parent.parent.name}: "), answer.path
        assert any(cell.startswith("solution") for cell in CELL.findall(answer.source)), answer.path
        assert (answer.entry["verdict"] == "passed") == (answer.kind == "correct"), answer.path
