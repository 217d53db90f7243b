"""The journal of a student's checks: what it keeps, and that nothing about it breaks a check."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from autograder import check_journal
from autograder.check_journal import JournalEntry
from autograder.verdict import State, Verdict, not_checked

if TYPE_CHECKING:
    from pathlib import Path


def verdict(score: float, exercise: str = "lab.talker") -> Verdict:
    state = State.PASSED if score == 10 else State.FAILED
    return Verdict(exercise, "The talker", state, score, 10.0)


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """This session's journal."""
    file = tmp_path / "course" / check_journal.NAME
    monkeypatch.setenv(check_journal.VARIABLE, str(file))
    return file


def test_a_check_is_a_line_and_the_best_one_counts(kept: Path) -> None:
    for score in (4.0, 10.0, 6.0):
        check_journal.note_check(verdict(score))
    check_journal.note_check(not_checked("lab.talker", "The talker", 10.0, "no domain is free"))
    lines = check_journal.entries(kept)
    assert [(entry.name, entry.points, entry.possible) for entry in lines] == [
        ("lab.talker", score, 10.0) for score in (4.0, 10.0, 6.0)
    ]
    assert check_journal.best(lines)["lab.talker"] == lines[1]


def test_a_task_that_was_solved_with_its_worked_solution_says_so_until_its_notebook_is_reset() -> None:
    def helped(*lines: JournalEntry) -> bool:
        return check_journal.best(lines)["lab.talker"].helped

    half, full = (JournalEntry("check", "lab.talker", 1, points, 10) for points in (5, 10))
    opened = JournalEntry("solution", "lab.talker", 2)
    assert helped(half, opened, full)
    assert not helped(full, opened, full)
    assert not helped(half, opened, half)
    assert not helped(half, JournalEntry("solution", "lab.listener", 2), full)
    assert not helped(half, opened, JournalEntry("reset", "lab", 3), full)


def test_five_failures_each_of_other_code_open_the_worked_solution() -> None:
    def failed(code: str, points: float = 0, *, nothing_seen: bool = False) -> JournalEntry:
        return JournalEntry("check", "lab.talker", 1, points, 10, code, nothing_seen)

    def may(*lines: JournalEntry) -> bool:
        return check_journal.may_open_solution("lab.talker", lines)

    empty, own = failed("0", nothing_seen=True), [failed(code) for code in "abcde"]
    assert may(*own)
    assert may(empty, *own)
    assert not may(empty, *own[1:])
    assert not may(*[own[0]] * 9)
    assert not may(*[empty] * 9)
    assert not may(*own[1:], failed("f", 10))
    assert not may(*own[1:], failed(""))
    assert not may(*own, JournalEntry("reset", "lab", 3))
    assert not check_journal.may_open_solution("lab.listener", own)


def test_a_link_in_anothers_folder_has_no_line_written_elsewhere(kept: Path, tmp_path: Path) -> None:
    own = tmp_path / ".bashrc"
    own.write_text("export A=1\n")
    kept.parent.mkdir()
    kept.symlink_to(own)
    assert not check_journal.note(JournalEntry("read", "lab", 1))
    assert own.read_text() == "export A=1\n"
    assert check_journal.entries(kept) == []


def test_each_line_of_a_journal_made_by_hand_is_looked_at_once() -> None:
    """Looking at all others for each would take minutes here."""
    checks = [JournalEntry("check", f"lab.{number}", 1, 1, 10) for number in range(30_000)]
    assert (
        len(check_journal.best([*checks, *(JournalEntry("reset", "other", 2) for _ in range(30_000))]))
        == 30_000
    )


def test_points_begin_anew_with_the_notebook(kept: Path) -> None:
    lines = [JournalEntry("check", "lab.talker", 1, 10, 10), JournalEntry("check", "lab_2.server", 2, 5, 10)]
    lines += [JournalEntry("reset", "lab", 3), JournalEntry("check", "lab.listener", 4, 3, 10)]
    assert sorted(check_journal.best(lines)) == ["lab.listener", "lab_2.server"]


def test_damaged_lines_are_left_out_and_the_next_one_is_kept(kept: Path) -> None:
    check_journal.note_check(verdict(4))
    good = kept.read_bytes()
    damaged = [
        b"\xff\xfe\x00",
        b'{"kind":"check"}',
        b'{"kind":"check","name":"lab.talker","time":1e300,"points":10,"possible":10}',
        b'{"kind":"grade","name":"lab.talker","time":1}',
        b"[" * 5000,
        good.strip()[:-9],  # a machine that went off
    ]
    kept.write_bytes(good + b"\n".join(damaged))
    check_journal.note_check(verdict(10))
    assert [entry.points for entry in check_journal.entries(kept)] == [4, 10]


@pytest.mark.parametrize("what", ["folder", "pipe", "no folder there"])
def test_what_is_no_journal_keeps_nobody_waiting(kept: Path, what: str) -> None:
    if what == "no folder there":
        kept.parent.write_text("a file")
    else:
        kept.parent.mkdir()
        (os.mkdir if what == "folder" else os.mkfifo)(kept)
    check_journal.note_check(verdict(10))
    assert not check_journal.note(JournalEntry("read", "lab", 1))
    assert check_journal.entries(kept) == []


def test_where_no_file_may_be_made_it_is_in_the_home_one_for_each_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "home"))
    assert check_journal.journal_path(tmp_path) == tmp_path / check_journal.NAME
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may write everywhere
    first, second = check_journal.journal_path(tmp_path / "a"), check_journal.journal_path(tmp_path / "b")
    assert first.parent == second.parent == tmp_path / "home" / "ros2-course"
    assert first != second
    assert check_journal.note(JournalEntry("read", "lab", 1), first)
    assert len(check_journal.entries(first)) == 1


def test_an_empty_name_means_no_journal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(check_journal.VARIABLE, "")
    assert check_journal.session_journal_path() is None
    assert not check_journal.note(JournalEntry("read", "lab", 1))
