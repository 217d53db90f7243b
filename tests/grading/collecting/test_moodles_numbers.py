"""The number in the name of a file of Moodle's is one student's in one assignment, and no list of students has it."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from downloads import write_zip

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

WORKSHEET = "Identifier,Full name,Email address,Grade\nParticipant 556,Guest,jose@uni.example,\n"


def test_whose_number_on_moodles_site_is_the_same_by_chance_gets_nobodys_work(
    tiny: TinyClass, tmp_path: Path
) -> None:
    (tiny.path / "students.csv").write_text(
        "id,first_name,last_name,email,moodle\neve,Eve,O'Neill,,\njose,José,Núñez,jose@uni.example,555\n",
        encoding="utf-8",
    )
    work = tiny.submit("x").read_text()
    shutil.rmtree(tiny.path / "submitted" / "x")
    names = (
        "Eve O'Neill_555_assignsubmission_file_lab_1_2.ipynb",
        "Guest_556_assignsubmission_file_lab_1_2.ipynb",
    )
    download = write_zip(tmp_path / "m.zip", dict.fromkeys(names, work))
    report = collect(tiny.path, [download])
    assert [one.student for one in report.having(LineState.PLACED)] == ["eve"]
    (guest,) = report.having(LineState.NOT_PLACED)
    assert "grading worksheet" in guest.reason
    assert "556" in guest.reason
    worksheet = tmp_path / "Grades-lab.csv"
    worksheet.write_text(WORKSHEET)
    placed = {one.student for one in collect(tiny.path, [download, worksheet]).having(LineState.PLACED)}
    assert placed == {"jose"}


def test_a_group_of_which_one_member_has_a_file_has_a_line(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text("id,email\nabe,abe@uni.example\nbea,bea@uni.example\n")
    work = tiny.submit("x").read_text()
    shutil.rmtree(tiny.path / "submitted" / "x")
    when = '"Sunday, 29 November 2026, 6:00 AM"'
    rows = [
        f"Participant {number},{name},{name}@uni.example,Team 7,,{when}"
        for number, name in ((1, "abe"), (2, "bea"))
    ]
    sheet = tmp_path / "Grades.csv"
    head = "Identifier,Full name,Email address,Group,Grade,Last modified (submission)"
    sheet.write_text("\n".join([head, *rows]))
    download = write_zip(tmp_path / "m.zip", {"Team 7-abe_1_assignsubmission_file_/lab_1_2.ipynb": work})
    (note,) = collect(tiny.path, [download, sheet]).notes
    assert note.startswith("the group Team 7 has handed in, but there is no file of bea: ")
    both = {
        f"Team 7-{name}_{number}_assignsubmission_file_/lab_1_2.ipynb": work
        for number, name in ((1, "abe"), (2, "bea"))
    }
    assert collect(tiny.path, [write_zip(tmp_path / "n.zip", both), sheet]).notes == ()
