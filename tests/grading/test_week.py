"""A week in one command: what was handed in, the points, and the LMS's list; what waits comes last."""

from __future__ import annotations

import contextlib
import shutil
import zipfile
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from downloads import write_zip
from tiny_class import FakeEngine, TinyClass

from autograder.cli import cli
from autograder.grading import week as weekly
from autograder.grading.grading_errors import GradingError
from autograder.grading.running import execution_backends
from autograder.grading.week import show_week, week
from tests.cases import cases

WEEKS = cases(__file__, "week")


@pytest.fixture
def folder(tiny: TinyClass, fake_engine: FakeEngine) -> TinyClass:
    return tiny


def downloaded(klass: TinyClass, place: Path, case: dict[str, Any]) -> list[Path]:
    """The files of a week; the talker's and the listener's points are what a student hands in."""
    files = {}
    for name, points in case["files"].items():
        files[name] = klass.submit("x", *points).read_text()
        shutil.rmtree(klass.path / "submitted" / "x")
    for name, text in case["lists"].items():
        (place / name).write_text(text, encoding="utf-8")
    return [write_zip(place / "download.zip", files), *(place / name for name in case["lists"])]


def cells(klass: TinyClass, case: dict[str, Any]) -> dict[str, str]:
    """What is in the filled list, by the cell that names the student."""
    who, points = case["columns"]
    return {row[who]: row[points] for row in klass.table(f"export/{case['into']}") if row[who]}


@pytest.mark.parametrize("system", WEEKS)
def test_each_number_of_a_week_arrives(
    folder: TinyClass, tmp_path: Path, capsys: pytest.CaptureFixture[str], system: str
) -> None:
    case = WEEKS[system]
    files = downloaded(folder, tmp_path, case)
    report = week(folder.path, files)
    assert report.exported is not None
    assert cells(folder, case) == case["cells"]
    show_week(report)
    lines = capsys.readouterr().out.splitlines()
    waiting = [place for place, line in enumerate(lines) if line.startswith("waits")]
    assert len(waiting) == len(case["waits"])
    assert waiting == list(range(len(lines) - len(waiting), len(lines))), "what waits comes last"
    for words, line in zip(case["waits"], lines[len(lines) - len(waiting) :], strict=True):
        assert words in line
        assert sum(words in one for one in lines) == 1, "each file that waits is named once"
    assert report.exit_code == (2 if waiting else 0)
    if "pages" in case:
        with zipfile.ZipFile(folder.path / "export" / case["pages"]) as pages:
            assert len(pages.namelist()) == case["count"]
    again = week(folder.path, files)
    assert (again.graded.executed, again.graded.written) == (0, 0)
    assert cells(folder, case) == case["cells"]


@pytest.mark.parametrize("step", ["grade", "_exported"])
def test_a_week_that_was_ended_goes_on(
    folder: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    files = downloaded(folder, tmp_path, WEEKS["canvas"])
    with monkeypatch.context() as patch:
        patch.setattr(weekly, step, lambda *_, **__: (_ for _ in ()).throw(KeyboardInterrupt))
        with contextlib.suppress(KeyboardInterrupt):
            week(folder.path, files)
    assert not (folder.path / "export").exists()
    week(folder.path, files)
    assert cells(folder, WEEKS["canvas"]) == WEEKS["canvas"]["cells"]


def test_a_changed_list_of_students_and_two_lists_are_questions(folder: TinyClass, tmp_path: Path) -> None:
    files = downloaded(folder, tmp_path, WEEKS["canvas"])
    week(folder.path, files)
    text = files[1].read_text("utf-8")
    files[1].write_text(f'{text}"Moss, Mia",105,,mia,Mon,,\n', encoding="utf-8")
    (question,) = week(folder.path, files).questions
    assert "changes the students of the class (add 1): type" in question
    other = Path(shutil.copy(files[1], tmp_path / "other.csv"))
    with pytest.raises(GradingError, match="name one list for the points"):
        week(folder.path, [*files, other])


ODD = cases(__file__, "odd")


@pytest.fixture(scope="module")
def _after_canvas(to_be_copied: TinyClass, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("downloads")
    files = downloaded(to_be_copied, place, WEEKS["canvas"])
    with FakeEngine().at_work(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(execution_backends, "require_sandbox", lambda _: None)
        patch.chdir(to_be_copied.path)
        week(to_be_copied.path, files)
    return place


@pytest.fixture
def after_canvas(
    _after_canvas: Path, to_be_copied: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> TinyClass:
    """A class after a week with Canvas, whose downloads lie beside it."""
    shutil.copytree(_after_canvas, tmp_path, dirs_exist_ok=True)
    return TinyClass(Path(shutil.copytree(to_be_copied.path, tmp_path / "class")))


@pytest.mark.parametrize("name", ODD)
def test_what_a_new_instructor_may_type(
    after_canvas: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """The commands of a case are typed in the class folder, after a week with Canvas; the last one counts."""
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)
    case, folder = ODD[name], after_canvas
    monkeypatch.chdir(folder.path)
    for name_of_file, text in case.get("files", {}).items():
        (tmp_path / name_of_file).write_text(text, encoding="utf-8")
    (folder.path / "class.toml").write_text(case.get("class", ""))
    words = [word.replace("DOWNLOADS", str(tmp_path)) for word in case["type"]]
    said = CliRunner().invoke(cli, words)
    assert (said.exception is None or isinstance(said.exception, SystemExit), said.exit_code) == (
        True,
        case["exit"],
    ), said.output
    for sentence in case["says"]:
        assert sentence in said.output, said.output
    table = (folder.path / "collected.csv").read_text("utf-8-sig")
    assert not any(name_of_file in table for name_of_file in case.get("files", {}))
