"""Each time that somebody is graded is kept, so that an appeal can be answered."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder.cli import cli
from autograder.grading.entering.attempts import read
from autograder.grading.errors import GradingError

if TYPE_CHECKING:
    from conftest import FakeEngine, TinyClass

pytestmark = pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")


def test_each_time_is_noted_with_what_came_of_it(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 4, 7)
    tiny.submit("ben")
    tiny.grade()
    tiny.grade()  # nothing is new
    tiny.grade(students=["ada"], again=True)
    tiny.submit("ada", 10, 7)
    tiny.grade()
    first, again, better = read(tiny.path, "ada")
    assert [[row.score for row in one.rows] for one in (first, again, better)] == [[4, 7], [4, 7], [10, 7]]
    assert first.work == again.work != better.work
    assert len(read(tiny.path, "ben")) == 1
    said = CliRunner().invoke(cli, ["attempts", str(tiny.path), "ada"]).output.splitlines()
    assert len(said) == 3
    assert "11/20  lab_1_2.talker 4 (wrong_text), lab_1_2.listener 7 (wrong_text)" in said[0]
    assert "17/20" in said[2]


def test_a_dry_run_is_no_attempt(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    tiny.grade(dry_run=True)
    with pytest.raises(GradingError, match="ada"):
        read(tiny.path, "ada")


def test_half_a_line_is_left_out(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    tiny.grade()
    with (tiny.path / ".autograder" / "attempts" / "ada.jsonl").open("ab") as log:
        log.write(b'{"at":"2026')
    assert len(read(tiny.path, "ada")) == 1
    tiny.submit("ada", 4, 7)
    tiny.grade()
    assert len(read(tiny.path, "ada")) == 2
