"""The table "One class" of docs/architecture.md, followed while a class of one student is graded."""

from __future__ import annotations

import json
import re
import sys
import threading
from typing import TYPE_CHECKING, Any

from tiny_class import TALKER, TinyClass

from autograder import course
from autograder.grading.batch import FLOW, grade

if TYPE_CHECKING:
    from pathlib import Path
    from types import CodeType

    import pytest


def rows() -> list[str]:
    """The rows of the table."""
    text = (course.root() / "docs" / "architecture.md").read_text(encoding="utf-8")
    return text.partition("**One class**")[2].partition("| --- |")[2].partition("\n\n")[0].splitlines()[1:]


def test_the_table_has_the_steps_of_the_code() -> None:
    assert [row.split("`")[1] for row in rows()] == [step.__name__ for step in FLOW]


def test_a_class_goes_through_these_files_in_this_order(
    tiny: TinyClass, with_fake_judge: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A step in the executor process is known by the stack that reaches the judge there."""
    table = [(file, name) for row in rows() for name, file in re.findall(r"`(\w+)` in `([\w/]+\.py)`", row)]
    assert len(table) >= 10
    stack = tmp_path / "stack.json"
    monkeypatch.setenv("STACK_OF_THE_FAKE_JUDGE", str(stack))
    codes: dict[CodeType, None] = {}

    def note(frame: Any, event: str, _: object) -> None:
        if event == "call":
            codes.setdefault(frame.f_code)

    tiny.submit("ada", 10, 10)
    threading.setprofile(note)
    sys.setprofile(note)
    try:
        grade(tiny.path, judge=with_fake_judge, jobs=1)
    finally:
        sys.setprofile(None)
        threading.setprofile(None)
    assert tiny.scores("ada")[TALKER] == 10
    called = list(dict.fromkeys(_step(code.co_filename, code.co_name) for code in codes))
    elsewhere = [_step(file, function) for file, function in json.loads(stack.read_text())]
    here = [step for step in table if step in called]
    assert here == [step for step in called if step in table]
    assert [step for step in table if step in elsewhere] == [step for step in elsewhere if step in table]
    assert [step for step in table if step not in called and step not in elsewhere] == []


def _step(file: str, function: str) -> tuple[str, str]:
    """The file as the table names it: below ``grading/``, or else below the package."""
    return file.rpartition("/autograder/")[2].removeprefix("grading/"), function
