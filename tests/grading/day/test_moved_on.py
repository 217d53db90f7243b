"""The course moves on while a class goes on: said before anybody is graded, with what brings it up to date."""

from __future__ import annotations

import errno
import io
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.console import Console
from tiny_class import LISTENER, MASTER, TALKER, FakeEngine, TinyClass, write_master

from autograder.grading import class_checks
from autograder.grading.grading_errors import DiskFull, GradingError
from autograder.grading.new_classes.new_class import new_class, renew


@pytest.fixture
def course(tmp_path: Path) -> Path:
    write_master(tmp_path / "course", "lab_1_2", MASTER)
    return tmp_path / "course"


@pytest.fixture
def tiny(course: Path, tmp_path: Path, fake_engine: FakeEngine) -> TinyClass:
    new_class(tmp_path / "class", course)
    return TinyClass(tmp_path / "class")


def change(course: Path, old: str, new: str) -> None:
    master = course / "solutions" / "chapter" / "lab_1_2" / "lab.md"
    assert old in master.read_text()
    master.write_text(master.read_text().replace(old, new))


def said(tiny: TinyClass) -> tuple[str, str]:
    """What is said before the first notebook is executed, and at the end."""
    console = Console(file=io.StringIO(), width=1000)
    report = tiny.grade(console=console)
    early = console.file.getvalue()  # type: ignore[attr-defined]
    return early, "\n".join(report.notices)


def test_a_class_hears_of_a_task_that_was_changed(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    assert "have changed since" not in "".join(said(tiny))
    change(course, "TODO: return ten.", "TODO: return twelve.")
    for words in said(tiny):
        assert "lab_1_2: the course's tasks have changed since this class got its notebook" in words
        assert f"./course renew-class {tiny.path} --assignment lab_1_2" in words


def test_a_class_hears_of_a_change_in_a_course_that_has_moved(
    course: Path, tmp_path: Path, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(class_checks, "course", SimpleNamespace(root=lambda: course))
    new_class(tmp_path / "class", course)
    tiny = TinyClass(tmp_path / "class")
    tiny.submit("ada", 4, 7)
    shutil.copytree(course, tmp_path / "clone")
    change(tmp_path / "clone", "TODO: return ten.", "TODO: return twelve.")
    monkeypatch.setattr(class_checks, "course", SimpleNamespace(root=lambda: tmp_path / "clone"))
    assert "lab_1_2: the course's tasks have changed" in "\n".join(said(tiny))


def test_a_class_that_wrote_nothing_down_says_so_until_it_is_renewed(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    (tiny.path / ".autograder" / "class.db").unlink()
    for words in said(tiny):
        assert "was made by an older version" in words
        assert f"./course renew-class {tiny.path}" in words
    renew(tiny.path, course)
    assert "made by an older version" not in "".join(said(tiny))


def test_a_corrected_typo_is_no_news(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    change(course, "Two answers, two checks.", "Two answers and two checks.")
    assert "have changed since" not in "".join(said(tiny))


def test_a_course_that_has_gone_is_no_news(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    shutil.rmtree(course)
    assert "have changed since" not in "".join(said(tiny))


def test_a_class_is_brought_up_to_date_and_keeps_what_it_had(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade()
    change(course, "TODO: return ten.", "TODO: return twelve.")
    lines = renew(tiny.path, course)
    assert "return twelve" in (tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb").read_text()
    assert "return twelve" in (tiny.path / "release" / "lab_1_2" / "lab_1_2.ipynb").read_text()
    (kept,) = (tiny.path / ".autograder" / "sources-before").glob("*/lab_1_2/lab_1_2.ipynb")
    assert "return ten" in kept.read_text()
    assert str(kept.parents[1]) in lines[-1]
    assert "have changed since" not in "".join(said(tiny))
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}


def test_what_nbgrader_refuses_leaves_the_class_as_it_was(tiny: TinyClass, course: Path) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade()
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    before = source.read_bytes()
    start = MASTER.index("Between the two.")
    change(course, MASTER[start:], "")  # nbgrader takes away no cell that somebody has points in
    with pytest.raises(GradingError, match="lab_1_2"):
        renew(tiny.path, course)
    assert source.read_bytes() == before
    assert tiny.grade().exit_code == 0


def test_only_what_the_class_has_is_brought_up_to_date(tiny: TinyClass, course: Path) -> None:
    with pytest.raises(GradingError, match="No assignment of the class is named lab_9_9"):
        renew(tiny.path, course, ["lab_9_9"])


def test_a_class_of_ones_own_assignments_is_not_renewed(tiny: TinyClass, course: Path) -> None:
    (tiny.path / "source" / "lab_1_2").rename(tiny.path / "source" / "own")
    released = sorted((tiny.path / "release").rglob("*"))
    with pytest.raises(GradingError, match="only assignments that the course does not have: own"):
        renew(tiny.path, course)
    assert sorted((tiny.path / "release").rglob("*")) == released


def test_a_full_disk_leaves_the_class_as_it_was(
    tiny: TinyClass, course: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    before = source.read_bytes()

    def full(path: Path, *_: object, **__: object) -> None:
        path.write_bytes(b"{")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(DiskFull):
        renew(tiny.path, course)
    assert source.read_bytes() == before
