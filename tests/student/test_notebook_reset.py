"""A notebook begun anew: the released one is back, and nothing that a student wrote is lost."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder import check_journal, course
from autograder.cli import cli
from autograder.student.notebook_reset import CannotReset, reset

if TYPE_CHECKING:
    from pathlib import Path

ROOT = course.root()
NOTEBOOK = "01_ros2_fundamentals/lab_1_2.ipynb"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A student's notebooks."""
    path = tmp_path / "chapters"
    path.joinpath(NOTEBOOK).parent.mkdir(parents=True)
    shutil.copy(ROOT / "chapters" / NOTEBOOK, path / NOTEBOOK)
    return path


def test_the_students_is_kept_each_time(folder: Path) -> None:
    released = (folder / NOTEBOOK).read_bytes()
    copies = []
    for work in ("first", "second"):
        (folder / NOTEBOOK).write_text(work)
        done = reset(ROOT, folder, NOTEBOOK, folder / check_journal.NAME)
        assert done.copy is not None
        copies.append(done.copy)
        assert (folder / NOTEBOOK).read_bytes() == released
    assert [copy.read_text() for copy in copies] == ["first", "second"]
    assert all(copy.name.startswith("lab_1_2 (your copy, ") for copy in copies)
    assert [entry.kind for entry in check_journal.entries(folder / check_journal.NAME)] == ["reset", "reset"]
    assert sorted(path.name for path in (folder / NOTEBOOK).parent.iterdir()) == sorted(
        ["lab_1_2.ipynb", *(copy.name for copy in copies)]
    )


def test_where_nothing_was_changed_there_is_no_copy_and_a_lost_one_comes_back(folder: Path) -> None:
    assert reset(ROOT, folder, "lab_1_2").copy is None
    (folder / NOTEBOOK).unlink()
    assert reset(ROOT, folder, "lab_1_2.ipynb").copy is None
    assert (folder / NOTEBOOK).is_file()


def test_an_unknown_name_is_refused_with_the_nearest(folder: Path) -> None:
    with pytest.raises(CannotReset, match="did you mean lab_1_2"):
        reset(ROOT, folder, "lab_12")


def test_what_cannot_be_written_stays_as_it_is(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / NOTEBOOK).write_text("work")

    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full_disk)
    with pytest.raises(CannotReset, match="No space left"):
        reset(ROOT, folder, "lab_1_2")
    assert (folder / NOTEBOOK).read_text() == "work"


def test_the_command_says_where_the_copy_is(folder: Path) -> None:
    (folder / NOTEBOOK).write_text("work")
    done = CliRunner().invoke(cli, ["reset", "lab_1_2", "--folder", str(folder)])
    assert (done.exit_code, "Your notebook was copied to " in done.output) == (0, True)
    refused = CliRunner().invoke(cli, ["reset", "lab_9", "--folder", str(folder)])
    assert (refused.exit_code, "no notebook is called 'lab_9'" in refused.output) == (2, True)
