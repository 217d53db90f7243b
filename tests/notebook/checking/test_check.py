"""What becomes of a check in a student's own notebook, and that a grader's kernel keeps nothing."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from autograder import check_journal, course, exercises
from autograder.cards.certificate import Certificate
from autograder.check_journal import JournalEntry
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.notebook.checking import check as check_cell
from autograder.notebook.checking.card_display import Progress
from autograder.verdict import State, Verdict
from autograder.workspaces import sources

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from pathlib import Path

    RunScript = Callable[..., subprocess.CompletedProcess[str]]


def passed(exercise: str) -> Verdict:
    return Verdict(exercise, "An exercise", State.PASSED, 10.0, 10.0)


def record(verdict: Verdict) -> None:
    with check_cell.recorded(verdict, "a path"):
        pass


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The certificates that a notebook has shown."""
    found: list[Any] = []
    monkeypatch.delenv(SOCKET_VARIABLE, raising=False)
    monkeypatch.setattr(check_cell, "notebook_shell", lambda: "a notebook")
    monkeypatch.setattr(check_cell, "is_live", lambda: True)
    monkeypatch.setattr(check_cell, "_show_certificate", found.append)
    return found


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / check_journal.NAME
    monkeypatch.setenv(check_journal.VARIABLE, str(file))
    return file


def test_the_check_that_ends_the_chapter_shows_the_certificate_once(shown: list[Any], kept: Path) -> None:
    chapter = course.chapters(course.root())[0]
    *others, last = [name for lab in chapter.labs for name in chapter.exercises_of(lab)]
    check_journal.note_solution(others[0])
    for name in others:
        record(passed(name))
    assert shown == []
    record(passed(last))
    record(passed(last))
    (one,) = shown
    assert (one.title, one.points, one.helped) == (chapter.title, 10.0 * (len(others) + 1), 1)
    assert len(check_journal.entries(kept)) == len(others) + 3


def test_the_certificate_is_a_card_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    display = importlib.import_module("IPython.display")
    cards: list[dict[str, str]] = []
    monkeypatch.setattr(display, "display", lambda card, raw: cards.append(card))
    check_cell._show_certificate(Certificate("Nodes", 130.0, 0.0, 2))
    assert "<svg" in cards[0]["text/html"]
    assert cards[0]["text/plain"].startswith("Chapter complete: Nodes.")
    assert "2 tasks with the worked solution" in cards[0]["text/html"].rpartition("<text")[0]


def test_a_graders_kernel_keeps_nothing(
    shown: list[Any], kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(SOCKET_VARIABLE, "/somewhere/judge.socket")
    record(passed("lab_1_2.talker"))
    assert not kept.exists()


@pytest.mark.parametrize("trouble", ["a folder", "no course"])
def test_no_trouble_of_the_journal_breaks_a_check(
    shown: list[Any], kept: Path, monkeypatch: pytest.MonkeyPatch, trouble: str
) -> None:
    if trouble == "a folder":
        kept.mkdir()
    else:
        monkeypatch.delenv(check_journal.VARIABLE)
        monkeypatch.setenv("AUTOGRADER_COURSE", str(kept))
    record(passed("lab_1_2.talker"))
    assert shown == []


def test_what_ended_before_is_not_shown_again(shown: list[Any], kept: Path) -> None:
    for name in exercises.all_ids():
        check_journal.note(JournalEntry("check", name, 1, 10, 10))
    record(passed(exercises.all_ids()[0]))
    assert shown == []


def test_a_class_whose_name_was_given_to_its_object_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    class Talker:
        pass

    talker = Talker()
    monkeypatch.setattr(check_cell, "notebook_shell", lambda: SimpleNamespace(user_ns={"Talker": talker}))
    with pytest.raises(TypeError, match=r"a line of yours says Talker = Talker\(\.\.\.\)"):
        check_cell.check("lab_9_1.talker", talker)
    with pytest.raises(TypeError, match="takes your class or function itself"):
        check_cell.check("lab_9_1.talker", Talker())


@pytest.mark.usefixtures("shown")
def test_a_check_that_cannot_be_kept_says_so(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept.mkdir()  # as on a full disk, nothing can be written there
    record(passed("lab_1_2.talker"))
    assert f"This check is not in your progress, because {kept} cannot be written" in capsys.readouterr().out


@pytest.mark.usefixtures("shown")
def test_on_a_full_disk_no_workspace_is_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "ROOM", 1 << 62)
    verdict = check_cell._ask("lab_1_1.hello", tmp_path, Progress())
    assert verdict is not None
    assert verdict.state is State.NOT_CHECKED
    assert verdict.diagnosis is not None
    assert f"The disk with {tmp_path} is full" in verdict.diagnosis.text


@pytest.mark.ros
def test_an_exercise_that_does_not_exist_is_answered_with_those_that_are_near(run_script: RunScript) -> None:
    done = run_script("from autograder.notebook import check\ncheck('lab_1_2.taker', print)")
    shown = " ".join(done.stdout.split())
    assert "no exercise is called 'lab_1_2.taker'; did you mean lab_1_2.talker" in shown
    assert "Correct the name of the exercise in this cell, and run the cell again." in shown
    assert "instructor" not in shown
