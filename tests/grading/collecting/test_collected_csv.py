"""``collected.csv``: what a person writes into it wins, however a spreadsheet has saved it, and nothing is lost."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip, zipped
from test_collect import lies, placed, stamp, why, work

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


def test_an_unknown_form_takes_two_cells(klass: TinyClass, tmp_path: Path) -> None:
    assert collect(klass.path, [unknown(klass, tmp_path)]).exit_code == 2
    edit(klass, "Ada und Ben", student="ada; ben")
    edit(klass, "x-zuse", student="Zoë Zuse", handed_in="2025-10-03 14:05")
    report = collect(klass.path)
    assert (report.exit_code, placed(report).keys()) == (0, {"ada", "ben", "zoe"})
    assert (lies(klass, "ben"), stamp(klass, "zoe")[:16]) == (work(klass, 3), "2025-10-03 14:05")
    report = collect(klass.path, [unknown(klass, tmp_path)])
    assert {one.state for one in report.outcomes} == {LineState.UNCHANGED}, (
        "edited cells win over later downloads"
    )
    edit(klass, "x-zuse", student="ben", use="no")
    collect(klass.path)
    assert not (klass.path / "submitted" / "zoe").exists(), "what collect wrote is withdrawn"
    edit(klass, "x-zuse", student="", use="", handed_in="")
    assert "does not identify a student" in why(collect(klass.path))


def test_an_archive_of_somebody_unknown_takes_one_cell(klass: TinyClass, tmp_path: Path) -> None:
    inner = zipped({"a/lab_1_2.ipynb": work(klass, 3), "a/notes.txt": "x"})
    collect(klass.path, [write_zip(tmp_path / "c.zip", {"guest_999_9001_x.zip": inner})])
    edit(klass, "guest_999", student="eve")
    report = collect(klass.path)
    assert (placed(report).keys(), lies(klass, "eve"), report.exit_code) == ({"eve"}, work(klass, 3), 0)


def test_the_person_says_the_assignment(klass: TinyClass, tmp_path: Path) -> None:
    nameless = work(klass, 3).replace('"grade_id"', '"nobody"')
    collect(klass.path, [write_zip(tmp_path / "c.zip", {"guest/homework.ipynb": nameless})])
    edit(klass, "homework", student="ada", assignment="lab_1_2")
    assert placed(collect(klass.path)).keys() == {"ada"}


def attempts(klass: TinyClass, tmp_path: Path) -> tuple[Path, Path]:
    """Two attempts of ada's, and nothing says which is the newer one."""
    one, other = work(klass, 3), work(klass, 4)
    return (
        write_zip(tmp_path / "1.zip", {"ada/lab_1_2.ipynb": one}),
        write_zip(tmp_path / "2.zip", {"ada/lab_1_2.ipynb": other}),
    )


def test_two_attempts_without_a_time_wait_and_one_cell_decides(klass: TinyClass, tmp_path: Path) -> None:
    assert len(collect(klass.path, attempts(klass, tmp_path)).having(LineState.NOT_PLACED)) == 2
    assert not (klass.path / "submitted" / "ada").exists()
    edit(klass, "2.zip", use="ja")
    assert placed(collect(klass.path)).keys() == {"ada"}
    assert lies(klass, "ada") == work(klass, 4)


def test_an_attempt_that_counts_goes_on_counting_and_the_new_one_waits(
    klass: TinyClass, tmp_path: Path
) -> None:
    first, second = attempts(klass, tmp_path)
    collect(klass.path, [first])
    report = collect(klass.path, [second])
    assert "it is unknown whether this file is newer than 1.zip/ada/lab_1_2.ipynb" in why(report)
    assert lies(klass, "ada") == work(klass, 3)
    assert {line["counts"] for line in read(klass)[1]} == {"yes", "waits"}
    collect(klass.path, [second, first])
    assert lies(klass, "ada") == work(klass, 3)
    edit(klass, "2.zip", use="yes")
    collect(klass.path)
    assert lies(klass, "ada") == work(klass, 4)


def test_a_no_at_the_only_file_takes_it_out_of_submitted(klass: TinyClass, tmp_path: Path) -> None:
    klass.submit("ben", 5)
    mine = lies(klass, "ben")
    collect(klass.path, [attempts(klass, tmp_path)[0]])
    edit(klass, "submitted/ben", use="no")
    collect(klass.path)
    assert not (klass.path / "submitted" / "ben").exists()
    edit(klass, "submitted/ben", use="yes")
    collect(klass.path)
    assert lies(klass, "ben") == mine


def test_a_correction_by_hand_counts_until_somebody_writes_no(klass: TinyClass, tmp_path: Path) -> None:
    for day, points in (("03", 1), ("04", 2)):
        name = f"Lab_ada_attempt_2025-10-{day}-14-00-00_lab_1_2.ipynb"
        if day == "04":
            (klass.path / "submitted" / "ada" / "lab_1_2" / "lab_1_2.ipynb").write_text(work(klass, 9))
        collect(klass.path, [write_zip(tmp_path / "b.zip", {name: work(klass, points)})])
    assert lies(klass, "ada") == work(klass, 9)
    edit(klass, "submitted/ada", use="no")
    collect(klass.path)
    assert lies(klass, "ada") == work(klass, 2)
    edit(klass, "submitted/ada", use="yes")
    collect(klass.path)
    assert lies(klass, "ada") == work(klass, 9), "its bytes are in the inbox"


def test_a_class_of_nbgraders_exchange_keeps_its_files(klass: TinyClass, tmp_path: Path) -> None:
    klass.submit("ben", 5)
    mine = lies(klass, "ben")
    collect(klass.path, [write_zip(tmp_path / "c.zip", {"lovelaceada_101_9001_lab_1_2.ipynb": work(klass)})])
    assert lies(klass, "ben") == mine
    counts = {line["system"]: line["counts"] for line in read(klass)[1]}
    assert counts == {"canvas": "yes", "by hand": "yes"}


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


@pytest.mark.parametrize(
    ("names", "file"),
    [
        ("{id}-{last}_{assignment}", "ada-Lovelace_lab_1_2.ipynb"),
        ("{last}, {first} ({any})/{file}", "Lovelace, Ada (x77)/lab_1_2.ipynb"),
        ("{any}__{email}", "s9__ada.love@uni.example/my.ipynb"),
    ],
)
def test_any_naming_can_be_said(klass: TinyClass, tmp_path: Path, names: str, file: str) -> None:
    report = collect(klass.path, [write_zip(tmp_path / "c.zip", {file: work(klass, 3)})], names=names)
    assert (placed(report).keys(), lies(klass, "ada")) == ({"ada"}, work(klass, 3))


def test_a_name_that_a_pattern_divides_in_two_ways_waits(klass: TinyClass, tmp_path: Path) -> None:
    (klass.path / "students.csv").write_text(f"{ROSTER}ben_b,Benno,Baum,,,\n", encoding="utf-8")
    files = {"Bär_Ben_ben_b_7/lab_1_2.ipynb": work(klass, 1), "Zuse_Zoë_zoe_8/lab_1_2.ipynb": work(klass, 2)}
    archive = write_zip(tmp_path / "c.zip", files)
    report = collect(klass.path, [archive], names="{last}_{first}_{id}_{any}")
    assert placed(report).keys() == {"zoe"}
    assert "may be ben, ben_b" in why(report)
