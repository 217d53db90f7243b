"""``collected.csv``: what a person writes into it wins, however a spreadsheet has saved it, and nothing is lost."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip
from test_collect import lies, stamp, work

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from tiny_class import TinyClass

Lines = list[dict[str, str]]


def read(klass: TinyClass) -> tuple[list[str], Lines]:
    """The columns and lines of the table, as any program for CSV reads them."""
    text = (klass.path / "collected.csv").read_text(encoding="utf-8-sig")
    reader = csv.DictReader(io.StringIO(text))
    return list(reader.fieldnames or []), list(reader)


def save(
    klass: TinyClass, columns: list[str], lines: Lines, separator: str = ",", letters: str = "utf-8-sig"
) -> None:
    """Save the table as a spreadsheet does."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, columns, delimiter=separator)
    writer.writeheader()
    writer.writerows(lines)
    (klass.path / "collected.csv").write_bytes(text.getvalue().encode(letters, "replace"))


def edit(klass: TinyClass, file: str, **cells: str) -> None:
    """Write cells into the lines whose file has this in its name."""
    columns, lines = read(klass)
    meant = [line for line in lines if file in line["file"]]
    assert meant, lines
    for line in meant:
        line.update(cells)
    save(klass, columns, lines)


def unknown(klass: TinyClass, tmp_path: Path) -> Path:
    return write_zip(
        tmp_path / "form.zip", {"Ada und Ben.ipynb": work(klass, 3), "x-zuse.ipynb": work(klass, 4)}
    )


def drop(lines: Lines) -> Lines:
    return lines[1:]


def double(lines: Lines) -> Lines:
    return [{**lines[0], "use": "no"}, *lines]


def turn(lines: Lines) -> Lines:
    return lines[::-1]


@pytest.mark.parametrize(
    ("change", "words"), [(drop, "lacks 1 lines"), (double, "has 2 different lines for"), (turn, "")]
)
def test_lines_that_are_missing_double_or_elsewhere_lose_nothing(
    klass: TinyClass, tmp_path: Path, change: Callable[[Lines], Lines], words: str
) -> None:
    files = {
        "lovelaceada_101_9001_lab_1_2.ipynb": work(klass, 1),
        "barben_102_9002_lab_1_2.ipynb": work(klass, 2),
    }
    collect(klass.path, [write_zip(tmp_path / "c.zip", files)])
    columns, lines = read(klass)
    save(klass, columns, change(lines))
    report = collect(klass.path)
    assert words in " ".join(report.notes)
    assert (lies(klass, "ada"), lies(klass, "ben")) == (work(klass, 1), work(klass, 2))
    assert len(read(klass)[1]) == 2


def test_excel_in_germany_saves_it_and_no_cell_is_taken_for_an_edit(klass: TinyClass, tmp_path: Path) -> None:
    klass.configure('c.NbGraderAPI.timezone = "Europe/Berlin"')
    (klass.path / "students.csv").write_text(f"{ROSTER}0017,Jörg,Müller,,900,\n", encoding="utf-8")
    files = {
        "mullerjorg_900_9001_lab_1_2.ipynb": work(klass, 1),
        "Lab_ben_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass, 2),
    }
    collect(klass.path, [write_zip(tmp_path / "c.zip", files)])
    text = (klass.path / "collected.csv").read_text(encoding="utf-8-sig")
    assert text.startswith("use;counts;student"), "in Germany a comma is in numbers"
    assert ";'0017;" in text, "no spreadsheet drops its zeros"
    lines = list(csv.DictReader(io.StringIO(text), delimiter=";"))
    for line in lines:
        line["student"] = line["student"].replace("'0017", "17")
        line["handed_in"] = {"ben": "03.10.2025 14:00", "17": "04.10.2025 09:30"}[line["student"]]
    save(klass, list(lines[0]), lines, ";", "cp1252")
    report = collect(klass.path)
    assert (report.notes, report.exit_code) == ((), 0)
    assert stamp(klass, "ben") == "2025-10-03 12:00:00.000000 UTC"
    assert stamp(klass, "0017") == "2025-10-04 07:30:00.000000 UTC"


def test_in_a_table_with_semicolons_no_reader_that_splits_at_commas_finds_a_formula(
    klass: TinyClass, tmp_path: Path
) -> None:
    klass.configure('c.NbGraderAPI.timezone = "Europe/Berlin"')
    names = ("x,+cmd|' /C calc'!A0,y.ipynb", 'x,"=1+1,y.txt', "x, @SUM(A1),y.txt")
    files = dict.fromkeys((f"Ada Lovelace_101_assignsubmission_file_/{name}" for name in names), "x")
    collect(klass.path, [write_zip(tmp_path / "c.zip", files)])
    text = (klass.path / "collected.csv").read_text(encoding="utf-8-sig")
    for separator in ";,\t|":
        cells = [cell for row in csv.reader(io.StringIO(text), delimiter=separator) for cell in row]
        assert not [cell for cell in cells if cell.lstrip()[:1] in tuple("=+-@")], separator


def test_a_table_that_was_open_while_others_collected_is_compared_with_itself(
    klass: TinyClass, tmp_path: Path
) -> None:
    collect(klass.path, [unknown(klass, tmp_path)])
    columns, old = read(klass)
    edit(klass, "x-zuse", student="zoe")
    collect(klass.path)
    (mine,) = (line for line in old if "Ada und Ben" in line["file"])
    mine["student"] = "ada"
    save(klass, columns, old)
    collect(klass.path)
    assert (lies(klass, "ada"), lies(klass, "zoe")) == (work(klass, 3), work(klass, 4))


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
