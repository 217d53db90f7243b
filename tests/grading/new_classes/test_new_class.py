from __future__ import annotations

import contextlib
import errno
import re
import sqlite3
from pathlib import Path

import nbformat
import pytest
from nbgrader import api
from nbgrader.preprocessors import SaveCells
from tiny_class import MASTER, TinyClass, write_master

from autograder.course import root
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import DiskFull, GradingError
from autograder.grading.new_classes.new_class import machine_timezone, new_class


@pytest.fixture
def course(tmp_path: Path) -> Path:
    write_master(tmp_path / "course", "lab_1_2", MASTER)
    write_master(tmp_path / "course", "reading", MASTER.partition("```")[0])
    return tmp_path / "course"


def test_what_is_handed_out_has_no_answer_and_the_source_has(tiny: TinyClass) -> None:
    released = "\n".join(cell.source for cell in tiny.released().cells)
    source = (tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb").read_text()
    assert "return 10\n" not in released.replace("return 10.0", "")
    assert "TODO: return ten" in released
    assert "return 10\\n" in source


def test_its_gradebook_has_the_version_that_nbgraders_own_would_have(tiny: TinyClass) -> None:
    with contextlib.closing(sqlite3.connect(tiny.path / "gradebook.db")) as book:
        versions = book.execute("SELECT version_num FROM alembic_version").fetchall()
    assert versions == [(api.get_alembic_version(),)]


def test_only_notebooks_with_a_check_become_assignments(course: Path, tmp_path: Path) -> None:
    (tmp_path / "class").mkdir()  # an empty folder will do
    made = new_class(tmp_path / "class", course)
    assert made.assignments == ("lab_1_2",)
    assert "./course grade" in made.summary()[-1]
    nbformat.validate(nbformat.read(made.path / "release" / "lab_1_2" / "lab_1_2.ipynb", as_version=4))


def test_a_class_has_the_time_zone_of_its_instructor(
    course: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TZ", ":America/Lima")
    for asked, zone in (("", "America/Lima"), ("Asia/Tokyo", "Asia/Tokyo")):
        made = new_class(tmp_path / (asked[:4] or "class"), course, timezone=asked)
        assert str(ClassDirectory(made.path).time_zone) == zone
        assert zone in made.summary()[1]
    monkeypatch.setenv("TZ", "LMT+5")
    assert machine_timezone() == "UTC"


def test_links_between_notebooks_lead_to_those_of_the_class_and_to_no_others(tmp_path: Path) -> None:
    made = new_class(tmp_path / "class", root(), assignments=["lab_1_2", "lab_1_3"])
    notebooks = sorted(made.path.glob("release/*/*.ipynb"))
    links = [
        notebook.parent / link
        for notebook in notebooks
        for cell in nbformat.read(notebook, as_version=4).cells
        for link in re.findall(r"\]\(([^()]+\.ipynb)\)", cell.source)
    ]
    assert notebooks[0].resolve() in [link.resolve() for link in links]
    assert [link for link in links if not link.exists()] == []


def test_nothing_that_is_there_is_touched(course: Path, tmp_path: Path) -> None:
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "thesis.txt").write_text("years of work")
    with pytest.raises(GradingError, match="is not empty"):
        new_class(tmp_path / "class", course)
    with pytest.raises(GradingError, match="is not a folder"):
        new_class(tmp_path / "class" / "thesis.txt", course)
    assert [path.name for path in (tmp_path / "class").iterdir()] == ["thesis.txt"]


def test_a_class_in_the_repository_is_refused_but_for_the_ignored_one(course: Path, tmp_path: Path) -> None:
    (tmp_path / "shortcut").symlink_to(course)
    for place in (course / "class", course / "solutions" / "class", tmp_path / "shortcut" / "class"):
        with pytest.raises(GradingError, match="inside the course's repository"):
            new_class(place, course)
        assert not place.exists()
    new_class(course / "demo-class", course)


def test_an_unknown_assignment_names_the_known_ones(course: Path, tmp_path: Path) -> None:
    with pytest.raises(
        GradingError, match=r"No lab of the course is named lab_9. Known names: lab_1_2, reading"
    ):
        new_class(tmp_path / "class", course, assignments=["lab_9"])
    assert not (tmp_path / "class").exists()


@pytest.mark.parametrize(
    ("where", "name", "raised", "error", "words"),
    [
        (SaveCells, "preprocess", RuntimeError("no more"), GradingError, "could not generate the assignment"),
        (Path, "write_text", OSError(errno.ENOSPC, "No space left"), DiskFull, "Free some space"),
        (Path, "mkdir", PermissionError(errno.EACCES, "No", "/"), GradingError, "do not have the right"),
    ],
    ids=["nbgrader fails", "full disk", "no right to write"],
)
def test_a_class_that_cannot_be_made_is_said_and_leaves_nothing(
    course: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    where: type,
    name: str,
    raised: Exception,
    error: type[GradingError],
    words: str,
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise raised

    with monkeypatch.context() as patch:
        patch.setattr(where, name, fail)
        with pytest.raises(error, match=words):
            new_class(tmp_path / "class", course)
    assert not (tmp_path / "class").exists()


def test_a_bad_master_is_said_and_leaves_nothing(course: Path, tmp_path: Path) -> None:
    write_master(course, "broken", MASTER.replace("### END SOLUTION", ""))
    with pytest.raises(GradingError, match=r"broken.lab.md"):
        new_class(tmp_path / "class", course)
    assert not (tmp_path / "class").exists()
