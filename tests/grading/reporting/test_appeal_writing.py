"""From a graded class to an appeal file: what the judge saw, for the points in the gradebook and nothing else."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
from dataclasses import replace
from typing import TYPE_CHECKING
from zipfile import ZipFile

import pytest
from click.testing import CliRunner
from tiny_class import QUIET, FakeEngine, TinyClass

from autograder import exercises
from autograder.appeals import appeal_file
from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory, switch_sandbox_off
from autograder.grading.course_version import judged_by
from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting.appeal_writing import write_appeal
from autograder.grading.running import execution_backends
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

ID = "lab_1_2.talker"


def evidence() -> bytes:
    """What a judge may hand over of a talker that is right."""
    stored = evidence_files.load_reference(ID)
    graph = Event(0.1, "interface", "graph", stored.interface)
    seen = Evidence([Part("talking", {}, [graph, *stored.parts[0].events])], stored)
    return evidence_files.pack(
        deciding.decide(exercises.get(ID), seen, "s"), seen, evidence_files.reference_digest(ID), at=1.8e9
    )


@pytest.fixture(scope="module")
def _graded(to_be_copied: TinyClass) -> Path:
    to_be_copied.submit("ada", 10, 7)
    engine = FakeEngine()
    engine.evidence[ID] = evidence()
    with engine.at_work(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(execution_backends, "require_sandbox", lambda _: None)
        to_be_copied.grade()
    return to_be_copied.path


@pytest.fixture
def graded(
    _graded: Path, fake_engine: FakeEngine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> TinyClass:
    """A class with one submission, of which a check has evidence."""
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)
    fake_engine.evidence[ID] = evidence()
    return TinyClass(shutil.copytree(_graded, tmp_path / "class"))


def kept(tiny: TinyClass, student: str = "ada") -> dict[str, bytes]:
    with ClassStore(ClassDirectory(tiny.path)) as store:
        found = store.evidence(student, ID)
    return found.checks if found else {}


def files(path: Path) -> dict[str, bytes]:
    with ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


def test_everything_about_the_check_is_in_the_file_and_it_is_judged_the_same(graded: TinyClass) -> None:
    file = write_appeal(graded.path, "ada", ID)
    assert file == graded.path / "appeals" / "ada-lab_1_2.talker.zip"
    appeal = appeal_file.read(file)
    check = appeal.check
    assert (check.student, check.assignment, check.notebook) == ("ada", "lab_1_2", "lab_1_2")
    assert check.course == judged_by(b"lab_1_2")
    assert [(cell.cell, cell.text) for cell in check.solution] == [
        ("Talker", ["def Talker():", "    return 10"])
    ]
    assert files(file)["expected.json"] == exercises.reference_path(ID).read_bytes()
    assert appeal.seen == evidence_files.unpack(evidence())
    done = CliRunner().invoke(cli, ["replay", str(file)])
    assert done.exit_code == 0, done.output
    assert "the same verdict" in done.output


def test_results_and_the_gradebook_have_no_evidence(graded: TinyClass) -> None:
    with ClassStore(ClassDirectory(graded.path)) as store:
        assert [result.evidence for result in store.results("ada", "lab_1_2").values()] == [{}]
    assert graded.scores("ada") == {"lab_1_2-talker": 10.0, "lab_1_2-listener": 7.0}


def test_where_a_person_says_so_the_file_is_somewhere_else(graded: TinyClass, tmp_path: Path) -> None:
    words = ["appeal", str(graded.path), "ada", ID, "-o", str(tmp_path / "here.zip")]
    done = CliRunner().invoke(cli, words)
    assert (done.exit_code, done.output.strip()) == (0, str(tmp_path / "here.zip"))
    assert appeal_file.read(tmp_path / "here.zip").check.student == "ada"
    assert CliRunner().invoke(cli, [*words[:-1], str(tmp_path)]).exit_code == 2


def test_a_course_that_expects_something_else_since_does_not_say_what_was_expected(
    graded: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(evidence_files, "reference_digest", lambda _: "another")
    assert "expected.json" not in files(write_appeal(graded.path, "ada", ID))


def test_the_page_of_the_student_is_in_the_file(graded: TinyClass) -> None:
    assert "page.html" not in files(write_appeal(graded.path, "ada", ID))
    graded.grade(feedback=True)
    page = graded.path / "feedback/ada/lab_1_2/lab_1_2.html"
    assert files(write_appeal(graded.path, "ada", ID))["page.html"] == page.read_bytes()


@pytest.mark.parametrize(("student", "exercise", "words"), cases(__file__, "what_is_not_there_is_named"))
def test_what_is_not_there_is_named(graded: TinyClass, student: str, exercise: str, words: str) -> None:
    done = CliRunner().invoke(cli, ["appeal", str(graded.path), student, exercise])
    assert done.exit_code == 2
    assert words in done.output
    assert not (graded.path / "appeals").exists()


def test_damaged_evidence_is_named(graded: TinyClass, fake_engine: FakeEngine) -> None:
    fake_engine.evidence[ID] = b"no evidence"
    graded.grade(again=True)
    with pytest.raises(GradingError, match=r"is damaged .*--student ada --again"):
        write_appeal(graded.path, "ada", ID)
    with contextlib.closing(sqlite3.connect(graded.path / ".autograder" / "class.db")) as book, book:
        book.execute("UPDATE evidence SET checks = substr(checks, 1, length(checks) - 3)")
    with pytest.raises(GradingError, match=r"No evidence of .*--student ada --again"):
        write_appeal(graded.path, "ada", ID)


def test_no_appeal_about_a_run_that_was_not_entered(graded: TinyClass) -> None:
    graded.submit("ben", 3, 3)
    graded.grade(dry_run=True)
    with pytest.raises(
        GradingError, match=r"are not in the gradebook, .* Enter the points first: .*--student ben"
    ):
        write_appeal(graded.path, "ben", ID)
    graded.grade()
    assert write_appeal(graded.path, "ben", ID).is_file()


def test_after_a_run_that_enters_nothing_an_appeal_is_about_the_grade_that_stands(graded: TinyClass) -> None:
    before = appeal_file.read(write_appeal(graded.path, "ada", ID))
    graded.submit("ada", 3, 3)
    graded.grade(dry_run=True)
    assert appeal_file.read(write_appeal(graded.path, "ada", ID)) == before


def test_evidence_of_a_run_before_does_not_stay_where_a_later_one_has_none(
    graded: TinyClass, fake_engine: FakeEngine
) -> None:
    fake_engine.evidence.clear()
    graded.grade(again=True)
    assert not kept(graded)


def test_trouble_of_the_graders_own_keeps_no_evidence(graded: TinyClass, fake_engine: FakeEngine) -> None:
    fake_engine.evidence[ID] = b"half of it"
    graded.submit("ada", "'die'")
    graded.grade()
    assert kept(graded) == {ID: evidence()}
    with pytest.raises(GradingError, match="are not in the gradebook"):
        write_appeal(graded.path, "ada", ID)


def test_what_a_judge_hands_over_comes_from_the_worker_and_from_no_notebook(
    tiny: TinyClass, with_fake_judge: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Through real workers: the notebook writes where it can, and only the judge's words are kept."""
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)
    switch_sandbox_off(tiny.path)
    tiny.submit("ada", "10 if print('evidence') is None else 0", 1)
    tiny.grade(jobs=1, judge=with_fake_judge, console=QUIET)
    assert kept(tiny) == {ID: b"lab_1_2.talker said 10", "lab_1_2.listener": b"lab_1_2.listener said 1"}


def test_the_verdict_of_the_evidence_is_the_present_one() -> None:
    """Else the tests above would show nothing."""
    found = evidence_files.unpack(evidence()).verdict
    assert (found.score, replace(found, seconds=0.0).passed) == (10.0, True)
