"""Who has other points than before is said before a run, after it, and at any time."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from click.testing import CliRunner
from instructor import by_person, due, penalty
from own_assignment import EngineWithAsserts, hand_in, write_assignment
from test_true_table import DUE, EARLY, LATE, total
from tiny_class import LISTENER, TALKER, shown

from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.running import execution_backends

if TYPE_CHECKING:
    import pytest
    from tiny_class import FakeEngine, TinyClass


def files(tiny: TinyClass) -> dict[str, bytes]:
    """What a run leaves, without the store and the logs."""
    found: dict[str, bytes] = {}
    for name in ("autograded", "feedback", "submitted"):
        found |= {str(path): path.read_bytes() for path in (tiny.path / name).rglob("*") if path.is_file()}
    return found | {"csv": (tiny.path / "grades.csv").read_bytes()}


def test_a_dry_run_enters_nothing_and_says_who_would_get_other_points(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    tiny.submit("ada", 4, 7)
    tiny.submit("ben", 4, 7)
    tiny.submit("eve", 4, 7)
    tiny.grade(feedback=True)
    by_person(tiny, "eve", TALKER, 9)
    tiny.submit("ben", 10, 7)
    tiny.submit("eve", 10, 7)
    (tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").unlink()  # a run makes this page again
    before = files(tiny)
    fake_engine.ran.clear()
    report = tiny.grade(dry_run=True, feedback=True)
    assert fake_engine.ran == ["ben", "eve"]
    assert report.would_change is not None
    assert [change.line() for change in report.would_change] == [
        "ben  lab_1_2.talker  4 → 10",
        "eve  lab_1_2.talker  4 → 10, the points that a person gave stay",
    ]
    assert "Nothing was entered. 2 results would change:" in shown(report)
    after = files(tiny)
    assert after.keys() == before.keys()
    assert tiny.scores("ben") == {TALKER: 4, LISTENER: 7}
    assert {name for name in before if before[name] != after[name]} == set()
    fake_engine.ran.clear()
    assert tiny.grade(feedback=True).would_change is None
    assert (fake_engine.ran, tiny.scores("ben")) == ([], {TALKER: 10, LISTENER: 7})
    assert "Nothing was entered. No result would change." in shown(tiny.grade(dry_run=True))


def test_a_run_of_one_student_changes_no_words_about_the_others(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    """Ben has handed in again, and waits for his own run: his row is that of the run that graded him."""
    tiny.submit("ada", 4, 7)
    tiny.submit("ben", "1/0", 7)
    tiny.grade()
    tiny.submit("ada", 5, 7)
    tiny.submit("ben", 9, 7)
    tiny.submit("eve", 9, 7)
    tiny.grade(students=["ada"])
    said = CliRunner().invoke(cli, ["compare", str(tiny.path)]).output
    assert [line for line in said.splitlines() if "→" in line][1:] == ["ada  lab_1_2.talker  4 → 5"], said
    tiny.grade()
    said = CliRunner().invoke(cli, ["compare", str(tiny.path)]).output
    assert [line.strip() for line in said.splitlines() if "→" in line][1:] == [
        "ben  lab_1_2.talker  0 → 9 (crashed → wrong_text)",
        "eve  lab_1_2.listener  – → 7 (wrong_text)",
        "eve  lab_1_2.talker  – → 9 (wrong_text)",
    ], said


def test_a_run_of_one_assignment_changes_no_words_about_the_others(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(execution_backends, "execute_all", EngineWithAsserts().execute_all)
    write_assignment(tiny)
    hand_in(tiny, "ada", "def add(a, b):\n    return 3")
    tiny.submit("ada", 4, 7)
    tiny.grade()
    tiny.submit("ada", 5, 7)
    tiny.grade(assignments=["lab_1_2"])
    said = CliRunner().invoke(cli, ["compare", str(tiny.path)]).output
    assert [line.strip() for line in said.splitlines() if "→" in line][1:] == [
        "ada  lab_1_2.talker  4 → 5"
    ], said


def test_a_dry_run_foresees_what_being_late_costs(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    penalty(tiny)
    due(tiny, DUE)
    tiny.submit("ada", 4, 7).with_name("timestamp.txt").write_text(EARLY)
    tiny.submit("ben", 4, 7).with_name("timestamp.txt").write_text(LATE)
    tiny.submit("eve", 4, 7).with_name("timestamp.txt").write_text(EARLY)

    def foreseen() -> list[str]:
        report = tiny.grade(dry_run=True)
        assert report.would_change is not None
        return [change.line() for change in report.would_change if change.exercise == "late"]

    why = "handed in 2026-01-11 12:00 UTC, due 2026-01-10 12:00 UTC"
    assert foreseen() == [f"ben  late  – → -11, {why}"]
    tiny.grade()
    assert foreseen() == []
    (tiny.path / "submitted" / "eve" / "lab_1_2" / "timestamp.txt").write_text(LATE)
    assert foreseen() == [f"eve  late  – → -11, {why}"]
    assert total(tiny, "eve") == 11
    tiny.grade()
    assert (total(tiny, "ben"), total(tiny, "eve"), foreseen()) == (0, 0, [])
    due(tiny, None)
    assert foreseen() == ["ben  late  -11 → –", "eve  late  -11 → –"]


def test_two_runs_can_be_compared_at_any_time(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    result = CliRunner().invoke(cli, ["compare", str(tiny.path)])
    assert result.exit_code == 2
    tiny.submit("ada", 4, 7)
    tiny.grade()
    tiny.grade()
    tiny.submit("ada", 10, 7)
    tiny.grade()
    by_person(tiny, "ada", LISTENER, 9)
    tiny.grade()
    last = CliRunner().invoke(cli, ["compare", str(tiny.path)]).output
    assert "1 difference" in last
    assert "ada  lab_1_2.listener  7 → 9" in last
    with ClassStore(ClassDirectory(tiny.path)) as store:
        names = store.runs()
    assert len(names) == 3, "a run that changes nothing is not kept"
    whole = CliRunner().invoke(cli, ["compare", str(tiny.path), names[0], names[-1]]).output
    assert "ada  lab_1_2.talker  4 → 10 (wrong_text → no mistake)" in whole
    data = json.loads(CliRunner().invoke(cli, ["compare", str(tiny.path), "--json"]).output)
    assert [(one["before"], one["after"]) for one in data["differences"]] == [(7, 9)]
    assert CliRunner().invoke(cli, ["compare", str(tiny.path), "yesterday"]).exit_code == 2
