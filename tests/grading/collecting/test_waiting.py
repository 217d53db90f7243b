"""A file without a place is repeated until it has one, though next week's file is called just as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip
from test_collect import work
from test_collected_csv import edit
from test_where_it_goes import other_lab

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.collecting.collect import CollectReport
    from autograder.grading.collecting.collected_csv import Waiting


@pytest.fixture
def klass(klass: TinyClass) -> TinyClass:
    """The tiny class with a roster, of two assignments."""
    other_lab(klass)
    return klass


def week(klass: TinyClass, folder: Path, text: str, name: str = "ada/homework.ipynb") -> CollectReport:
    """Collect the download of a week, which is called as that of every week."""
    return collect(klass.path, [write_zip(folder / "submissions.zip", {name: text})])


def waiting(klass: TinyClass) -> list[Waiting]:
    return Table(ClassDirectory(klass.path)).waiting()


def nameless(klass: TinyClass, points: int) -> str:
    return work(klass, points).replace('"grade_id"', '"nobody"')


def test_what_is_only_called_alike_does_not_settle_it(klass: TinyClass, tmp_path: Path) -> None:
    week(klass, tmp_path, nameless(klass, 1))
    report = week(klass, tmp_path, work(klass, 2))
    assert [one.state for one in report.outcomes] == [LineState.PLACED]
    assert [one.label.rpartition(" ")[0] for one in waiting(klass)] == ["submissions.zip/ada/homework.ipynb"]
    week(klass, tmp_path, nameless(klass, 3))
    assert len(waiting(klass)) == 2, "neither says what it is: both may be work"


def test_collected_again_it_is_repeated_once(klass: TinyClass, tmp_path: Path) -> None:
    for name in ("ada/homework.ipynb", "guest/homework.ipynb", "ada/lab_1_2.rar"):
        for _ in range(2):
            week(klass, tmp_path, nameless(klass, 1) if name.endswith("ipynb") else "Rar!", name)
    assert len(waiting(klass)) == 3


def test_a_cell_settles_it(klass: TinyClass, tmp_path: Path) -> None:
    week(klass, tmp_path, nameless(klass, 1))
    edit(klass, "homework", assignment="lab_1_2")
    assert [one.state for one in collect(klass.path).outcomes] == [LineState.PLACED]
    assert waiting(klass) == []


def test_the_same_bytes_from_somebody_else_do_not(klass: TinyClass, tmp_path: Path) -> None:
    week(klass, tmp_path, work(klass, 1), "guest/lab_1_2.ipynb")
    week(klass, tmp_path, work(klass, 1), "ben/lab_1_2.ipynb")
    assert [one.label.rpartition(" ")[0] for one in waiting(klass)] == ["submissions.zip/guest/lab_1_2.ipynb"]


def test_who_is_known_now_has_it_settled(klass: TinyClass, tmp_path: Path) -> None:
    week(klass, tmp_path, work(klass, 1), "guest/lab_1_2.ipynb")
    (klass.path / "students.csv").write_text(f"{ROSTER}guest,Guy,Est,,,\n", encoding="utf-8")
    week(klass, tmp_path, work(klass, 1), "guest/lab_1_2.ipynb")
    assert waiting(klass) == []


def test_two_files_of_one_name_are_two_lines(klass: TinyClass, tmp_path: Path) -> None:
    for text in ("Rar! one", "Rar! two"):
        week(klass, tmp_path, text, "ada/lab_1_2.rar")
    assert len(waiting(klass)) == 2


@pytest.mark.parametrize(
    ("name", "text", "column"),
    [
        ("group-7/lab_1_2.ipynb", "", "student"),
        ("ada/homework.ipynb", "nameless", "assignment"),
        ("ada/photo.jpg", "jpg", "use"),
        ("guest/photo.jpg", "jpg", "use"),
        ("ada/lab_1_2.rar", "Rar!", "use"),
        ("ada/lab_1_2.zip", "no zip", "use"),
    ],
)
def test_every_line_that_waits_says_which_cell_to_edit(
    klass: TinyClass, tmp_path: Path, name: str, text: str, column: str
) -> None:
    texts = {"": work(klass), "nameless": nameless(klass, 1)}
    report = week(klass, tmp_path, texts.get(text, text), name)
    (line,) = waiting(klass)
    assert line.sentence.endswith(f" (collected.csv, line 2, cell {column})")
    assert f"under {column}" in report.having(LineState.NOT_PLACED)[0].reason


def test_the_order_of_one_system_says_nothing_of_a_file_from_elsewhere(
    klass: TinyClass, tmp_path: Path
) -> None:
    """Canvas numbers its files; that a file from elsewhere has no such number does not make it older."""
    canvas = write_zip(tmp_path / "canvas.zip", {"lovelaceada_101_9001_lab_1_2.ipynb": work(klass, 1)})
    collect(klass.path, [canvas])
    report = week(klass, tmp_path, work(klass, 2), "ada/lab_1_2.ipynb")
    (line,) = waiting(klass)
    assert (
        "it is unknown whether this file is newer than canvas.zip/lovelaceada_101_9001_lab_1_2.ipynb"
        in line.reason
    )
    assert not report.having(LineState.EARLIER)


@pytest.mark.parametrize("letters", ["utf-16", "utf-16-le", "latin-1"])
@pytest.mark.parametrize("name", ["lab_1_2.ipynb", "homework.ipynb"])
def test_a_notebook_that_cannot_be_read_waits_instead_of_being_zero(
    klass: TinyClass, tmp_path: Path, letters: str, name: str
) -> None:
    text = work(klass, 3).replace('"cells"', '"größe": 1, "cells"', 1)
    archive = write_zip(tmp_path / "c.zip", {f"ada/{name}": text.encode(letters), "ben/lab_1_2.ipynb": text})
    report = collect(klass.path, [archive])
    assert [one.student for one in report.having(LineState.PLACED)] == ["ben"]
    (line,) = report.having(LineState.NOT_PLACED)
    assert (line.student, report.exit_code) == ("ada", 2)
    assert "The file is not a notebook: it is not " in line.reason
    edit(klass, name, use="yes", assignment="lab_1_2")
    placed = {one.student for one in collect(klass.path).having(LineState.PLACED)}
    assert "ada" in placed, "a person may have it graded as it is"
