"""Who has other points than before is said before a run and after it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from instructor import by_person, due, penalty
from own_assignment import EngineWithAsserts, hand_in, write_assignment
from test_true_table import DUE, EARLY, LATE, total
from tiny_class import LISTENER, TALKER, shown

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


NOTHING_OF_EVE = {("eve", f"lab_1_2.{name}", "", "") for name in ("talker", "listener")}


def results(tiny: TinyClass) -> set[tuple[str, ...]]:
    """The student, exercise, points and diagnosis in each line of ``grades.csv``."""
    columns = ("student", "exercise", "score", "diagnosis")
    return {tuple(row[name] for name in columns) for row in tiny.table()}


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
    lost = tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html"
    lost.unlink()
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
    assert lost.is_file(), "a run makes a lost page again"
    assert "Nothing was entered. No result would change." in shown(tiny.grade(dry_run=True))


def test_a_run_of_one_student_changes_no_words_about_the_others(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    """Ben has handed in again, and waits for his own run: his row is that of the run that graded him."""
    tiny.submit("ada", 4, 7)
    tiny.submit("ben", "1/0", 7)
    tiny.grade()
    first = results(tiny)
    tiny.submit("ada", 5, 7)
    tiny.submit("ben", 9, 7)
    tiny.submit("eve", 9, 7)
    tiny.grade(students=["ada"])
    second = results(tiny)
    assert second - first == {("ada", "lab_1_2.talker", "5", "wrong_text"), *NOTHING_OF_EVE}
    tiny.grade()
    assert results(tiny) - second == {
        ("ben", "lab_1_2.talker", "9", "wrong_text"),
        ("eve", "lab_1_2.listener", "7", "wrong_text"),
        ("eve", "lab_1_2.talker", "9", "wrong_text"),
    }


def test_a_run_of_one_assignment_changes_no_words_about_the_others(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(execution_backends, "execute_all", EngineWithAsserts().execute_all)
    write_assignment(tiny)
    hand_in(tiny, "ada", "def add(a, b):\n    return 3")
    tiny.submit("ada", 4, 7)
    tiny.grade()
    first = results(tiny)
    tiny.submit("ada", 5, 7)
    tiny.grade(assignments=["lab_1_2"])
    assert results(tiny) - first == {("ada", "lab_1_2.talker", "5", "wrong_text")}


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
