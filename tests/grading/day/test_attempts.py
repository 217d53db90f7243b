"""Each time that somebody is graded is kept, so that an appeal can be answered."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from click.testing import CliRunner

from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

    from autograder.grading.class_records import Attempt


def attempts(tiny: TinyClass, student: str) -> list[Attempt]:
    with ClassStore(ClassDirectory(tiny.path)) as store:
        return store.attempts(student)


def test_each_time_is_noted_with_what_came_of_it(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 4, 7)
    tiny.submit("ben")
    tiny.grade()
    tiny.grade()  # nothing is new
    tiny.grade(students=["ada"], again=True)
    tiny.submit("ada", 10, 7)
    tiny.grade()
    first, again, better = attempts(tiny, "ada")
    assert [[row.score for row in one.rows] for one in (first, again, better)] == [[4, 7], [4, 7], [10, 7]]
    assert first.made_from == again.made_from != better.made_from
    assert len(attempts(tiny, "ben")) == 1
    said = CliRunner().invoke(cli, ["attempts", str(tiny.path), "ada"]).output.splitlines()
    assert len(said) == 3
    assert "11/20  lab_1_2.talker 4 (wrong_text), lab_1_2.listener 7 (wrong_text)" in said[0]
    assert "17/20" in said[2]
    assert [line.rpartition("[")[2].partition(",")[0] for line in said] == [
        "first attempt",
        "nothing changed",
        "the submission changed",
    ]
    data = json.loads(CliRunner().invoke(cli, ["attempts", str(tiny.path), "ada", "--json"]).output)
    assert [sum(row["score"] for row in one["rows"]) for one in data["attempts"]] == [11, 11, 17]


def test_a_dry_run_is_no_attempt(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    tiny.grade(dry_run=True)
    said = CliRunner().invoke(cli, ["attempts", str(tiny.path), "ada"])
    assert (said.exit_code, attempts(tiny, "ada")) == (2, [])
    assert "No student with the id 'ada' was graded in this class" in said.output
