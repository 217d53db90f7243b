"""What an LMS lets an instructor download lies in its place afterwards, or has a line that says why it does not."""

from __future__ import annotations

import io
import os
import struct
import subprocess
import sys
import tracemalloc
import unicodedata
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

import nbformat
import pytest
from click.testing import CliRunner
from downloads import ROSTER, write_zip, zipped

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import Inbox, LineState
from autograder.grading.grading_errors import GradingError
from autograder.grading.tasks.submission_times import is_not_believed, read_timestamp

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

    from autograder.grading.collecting.collect import CollectReport

BERLIN = ZoneInfo("Europe/Berlin")


def work(klass: TinyClass, talker: object = 10, listener: object = 10) -> str:
    path = klass.submit("nobody", talker, listener)
    text = path.read_text()
    for part in (path, path.parent, path.parent.parent):
        part.unlink() if part.is_file() else part.rmdir()
    return text


def placed(report: CollectReport) -> dict[str, str]:
    return {one.student: one.label.rpartition("/")[2] for one in report.having(LineState.PLACED)}


def why(report: CollectReport) -> str:
    return "\n".join(f"{one.label}: {one.reason}" for one in report.having(LineState.NOT_PLACED))


def kept(klass: TinyClass) -> list[str]:
    """The texts of all notebooks in the inbox that do not count."""
    inbox = Inbox(klass.path / ".autograder")
    lines = Table(ClassDirectory(klass.path)).lines()
    earlier = {line["file"].rpartition(" ")[2] for line in lines if line["counts"] in ("earlier", "waits")}
    arrivals = (one for delivery in inbox.deliveries.values() for one in delivery.arrivals)
    contents = {one.content for one in arrivals if one.key in earlier}
    return sorted(inbox.read(content).decode(errors="replace") for content in contents)


def lies(klass: TinyClass, student: str) -> str:
    return (klass.path / "submitted" / student / "lab_1_2" / "lab_1_2.ipynb").read_text()


def stamp(klass: TinyClass, student: str) -> str:
    return (klass.path / "submitted" / student / "lab_1_2" / "timestamp.txt").read_text().strip()


def test_moodle_as_files_and_as_folders(klass: TinyClass, tmp_path: Path) -> None:
    one, two = work(klass, 1), work(klass, 2)
    moodle = write_zip(
        tmp_path / "moodle.zip",
        {
            "Ada Lovelace_12345_assignsubmission_file_lab_1_2.ipynb": one,
            "José Núñez_12346_assignsubmission_file/lab_1_2 (1).ipynb": two,
            "Ben Bär_12347_assignsubmission_file_/lab_1_2.ipynb": one,
            "Ben Bär_12347_assignsubmission_onlinetext_/onlinetext.html": "<p>hello</p>",
        },
    )
    worksheet = tmp_path / "Grades.csv"
    worksheet.write_text(
        "\ufeffIdentifier,Full name,Email address,Status,Grade,Maximum Grade,Last modified (submission)\n"
        'Participant 12345,Ada Lovelace,ada.love@uni.example,Submitted,,20,"Friday, 3 October 2025, 2:05 PM"\n'
        'Participant 12346,José Núñez,jose@uni.example,Submitted,,20,"Friday, 3 October 2025, 14:06"\n',
        encoding="utf-8",
    )
    report = collect(klass.path, [moodle, worksheet], zone=BERLIN)
    assert not why(report)
    assert placed(report).keys() == {"ada", "jose", "ben"}
    assert (lies(klass, "ada"), lies(klass, "jose")) == (one, two)
    assert stamp(klass, "ada") == "2025-10-03 12:05:00.000000 UTC"
    assert stamp(klass, "jose") == "2025-10-03 12:06:00.000000 UTC"
    assert [one.student for one in report.having(LineState.BESIDE)] == ["", "ben"]
    assert report.missing == {"lab_1_2": ("eve", "zoe")}


def test_canvas_marks_what_is_late_and_numbers_what_was_handed_in_again(
    klass: TinyClass, tmp_path: Path
) -> None:
    one, two = work(klass, 1), work(klass, 2)
    report = collect(
        klass.path,
        [
            write_zip(
                tmp_path / "submissions.zip",
                {
                    "lovelaceada_101_9001_lab_1_2.ipynb": one,
                    "lovelaceada_101_9002_lab_1_2-1.ipynb": two,
                    "oneilleve_LATE_104_9003_lab_1_2-3.ipynb": one,
                    "zusezoe_105_9004_my work.ipynb": two,
                },
            )
        ],
    )
    assert not why(report)
    assert lies(klass, "ada") == two
    assert [one.label for one in report.having(LineState.EARLIER)] == [
        "submissions.zip/lovelaceada_101_9001_lab_1_2.ipynb"
    ]
    assert {one.student: one.late for one in report.having(LineState.PLACED)} == {
        "ada": False,
        "eve": True,
        "zoe": False,
    }
    assert lies(klass, "zoe") == two, "told from its cells"


def test_blackboard_says_when(klass: TinyClass, tmp_path: Path) -> None:
    one, two = work(klass, 1), work(klass, 2)
    report = collect(
        klass.path,
        [
            write_zip(
                tmp_path / "gradebook_ROS_lab.zip",
                {
                    "Lab 1.2_ada_attempt_2025-10-03-14-05-06_lab_1_2.ipynb": one,
                    "Lab 1.2_ada_attempt_2025-10-04-14-05-06_lab_1_2.ipynb": two,
                    "Lab 1.2_ada_attempt_2025-10-03-14-05-06.txt": "Name: Ada Lovelace (ada)",
                    "Lab_1_2_ben_attempt_2025-11-03-14-05-06_lab_1_2.ipynb": one,
                },
            )
        ],
        zone=BERLIN,
    )
    assert not why(report)
    assert lies(klass, "ada") == two
    assert stamp(klass, "ada") == "2025-10-04 12:05:06.000000 UTC"
    assert stamp(klass, "ben") == "2025-11-03 13:05:06.000000 UTC"


def test_brightspace_says_when_in_the_folders_name(klass: TinyClass, tmp_path: Path) -> None:
    report = collect(
        klass.path,
        [
            write_zip(
                tmp_path / "Lab Download Oct 5, 2025.zip",
                {
                    "index.html": "<html>",
                    "12345-67890 - Ada Lovelace - Oct 3, 2025 205 PM/lab_1_2.ipynb": work(klass, 1),
                    "12346-67890 - Eve O'Neill - October 3, 2025 1205 AM/lab_1_2.ipynb": work(klass, 1),
                },
            )
        ],
        zone=ZoneInfo("UTC"),
    )
    assert not why(report)
    assert stamp(klass, "ada") == "2025-10-03 14:05:00.000000 UTC"
    assert stamp(klass, "eve") == "2025-10-03 00:05:00.000000 UTC"


def test_google_and_github_classroom(klass: TinyClass, tmp_path: Path) -> None:
    one = work(klass, 1)
    google = write_zip(
        tmp_path / "drive.zip",
        {"Lab/Ada Lovelace - lab_1_2.ipynb": one, "Lab/Zoë Zuse - lab_1_2(1).ipynb": one},
    )
    clone = tmp_path / "lab-1-2-submissions"
    for name in ("josen", "zz-top"):
        folder = clone / f"lab-1-2-{name}"
        (folder / ".git").mkdir(parents=True)
        (folder / ".git" / "lab_1_2.ipynb").write_text("no")
        (folder / "lab_1_2.ipynb").write_text(one)
    grades = tmp_path / "grades.csv"
    grades.write_text(
        "assignment_name,github_username,roster_identifier,submission_timestamp\n"
        "lab,josen,jose@uni.example,2025-10-03 14:05:06 UTC\n"
    )
    assert placed(collect(klass.path, [google], names="{name} - {file}")).keys() == {"ada", "zoe"}
    report = collect(klass.path, [clone, grades], names="{any}/lab-1-2-{github}")
    assert placed(report).keys() == {"jose"}, "the others' is there already"
    assert stamp(klass, "jose") == "2025-10-03 14:05:06.000000 UTC"


def test_names_that_a_mac_writes_are_the_same_names(klass: TinyClass, tmp_path: Path) -> None:
    name = unicodedata.normalize("NFD", "José Núñez_12346_assignsubmission_file_lab_1_2.ipynb")
    report = collect(klass.path, [write_zip(tmp_path / "m.zip", {name: work(klass)})])
    assert placed(report).keys() == {"jose"}


def test_a_zip_that_a_student_handed_in_is_opened(klass: TinyClass, tmp_path: Path) -> None:
    inner = zipped(
        {"my lab/lab_1_2 (2).ipynb": work(klass, 3), "my lab/notes.txt": "x", "__MACOSX/._a.ipynb": "x"}
    )
    name = "Ada Lovelace_12345_assignsubmission_file_lab.zip"
    report = collect(klass.path, [write_zip(tmp_path / "m.zip", {name: inner})])
    assert not why(report)
    assert lies(klass, "ada") == work(klass, 3)


def test_what_cannot_be_placed_is_listed_with_its_reason(klass: TinyClass, tmp_path: Path) -> None:
    one = work(klass)
    (klass.path / "students.csv").write_text(ROSTER + "ada2,Ada,Lovelace,ada2@uni.example,,\n")
    other = klass.released()
    other.cells = [nbformat.v4.new_code_cell("1")]
    report = collect(
        klass.path,
        [
            write_zip(
                tmp_path / "m.zip",
                {
                    "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb": one,
                    "Guest User_2_assignsubmission_file_lab_1_2.ipynb": one,
                    "Ben Bär_3_assignsubmission_file_homework.ipynb": nbformat.writes(other),
                    "readme.ipynb": one,
                },
            )
        ],
    )
    assert report.having(LineState.PLACED) == ()
    assert report.exit_code == 2
    lines = dict(line.partition(": ")[::2] for line in why(report).splitlines())
    assert "may be ada, ada2" in lines["m.zip/Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb"]
    assert (
        "no student in the class is called Guest User"
        in lines["m.zip/Guest User_2_assignsubmission_file_lab_1_2.ipynb"]
    )
    assert (
        "write the assignment under assignment"
        in lines["m.zip/Ben Bär_3_assignsubmission_file_homework.ipynb"]
    )
    assert "does not identify a student" in lines["m.zip/readme.ipynb"]
    assert not list((klass.path / "submitted").iterdir())
    again = collect(klass.path, [tmp_path / "m.zip"], assignment="lab_1_2")
    assert placed(again).keys() == {"ben"}


def test_the_newest_counts_also_later_and_nothing_is_lost(klass: TinyClass, tmp_path: Path) -> None:
    def blackboard(name: str, hour: int, content: str) -> Path:
        return write_zip(tmp_path / name, {f"Lab_ada_attempt_2025-10-03-{hour}-00-00_lab_1_2.ipynb": content})

    one, two, three = work(klass, 1), work(klass, 2), work(klass, 3)
    second = blackboard("b.zip", 15, two)
    assert placed(collect(klass.path, [second])).keys() == {"ada"}
    assert (len(collect(klass.path, [second]).having(LineState.UNCHANGED)), lies(klass, "ada")) == (1, two)
    first = collect(klass.path, [blackboard("a.zip", 14, one)])
    assert (len(first.having(LineState.EARLIER)), first.exit_code, lies(klass, "ada")) == (1, 0, two)
    last = collect(klass.path, [blackboard("c.zip", 16, three)])
    assert (last.having(LineState.PLACED)[0].reason, lies(klass, "ada")) == (
        "instead of an earlier file",
        three,
    )
    assert kept(klass) == sorted([one, two])
    assert collect(klass.path, [second]).having(LineState.EARLIER)
    assert lies(klass, "ada") == three


def test_what_is_kept_is_not_larger_than_what_was_sent(klass: TinyClass, tmp_path: Path) -> None:
    names = [f"lab_1_2 ({number}).ipynb" for number in range(1, 6)]
    with zipfile.ZipFile(tmp_path / "work.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, name.encode() + bytes(1_000_000))
    sent = (tmp_path / "work.zip").read_bytes()
    write_zip(tmp_path / "a.zip", {"Lab_ada_attempt_2025-10-03-14-00-00_work.zip": sent})
    report = collect(klass.path, [tmp_path / "a.zip"])
    assert len(report.having(LineState.NOT_PLACED)) == 5
    inbox = klass.path / ".autograder" / "inbox"
    assert sum(path.stat().st_size for path in inbox.glob("*.zip")) <= 3 * len(sent)


def test_two_files_of_which_nothing_says_which_is_newer_are_both_listed(
    klass: TinyClass, tmp_path: Path
) -> None:
    report = collect(
        klass.path,
        [
            write_zip(
                tmp_path / "m.zip",
                {
                    "Ada Lovelace_1_assignsubmission_file/a/lab_1_2.ipynb": work(klass, 1),
                    "Ada Lovelace_1_assignsubmission_file/b/lab_1_2.ipynb": work(klass, 2),
                },
            )
        ],
    )
    assert (len(report.having(LineState.PLACED)), len(report.having(LineState.NOT_PLACED))) == (0, 2)
    assert "several different files" in why(report)


def test_a_notebook_that_nobody_collected_is_not_overwritten(klass: TinyClass, tmp_path: Path) -> None:
    mine = klass.submit("ada", 7).read_text()
    report = collect(
        klass.path,
        [write_zip(tmp_path / "m.zip", {"Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb": work(klass)})],
    )
    (other,) = report.having(LineState.EARLIER)
    assert "was put into the folder submitted by hand, and is graded" in other.reason
    assert lies(klass, "ada") == mine


def test_only_the_collectors_time_counts(klass: TinyClass, fake_engine: FakeEngine, tmp_path: Path) -> None:
    from nbgrader.api import Gradebook

    archive = {
        "Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass),
        "Lab_ada_attempt_2025-10-03-14-00-00_timestamp.txt": "2025-01-01 00:00:00 UTC",
    }
    collect(klass.path, [write_zip(tmp_path / "b.zip", archive)], zone=ZoneInfo("UTC"))
    klass.submit("ben").with_name("timestamp.txt").write_text("2025-01-01 00:00:00.000000 UTC")
    folder = klass.path / "submitted" / "ada" / "lab_1_2"
    (folder / "timestamp.txt").write_text("2025-01-01 00:00:00.000000 UTC")
    report = klass.grade()
    with Gradebook(f"sqlite:///{klass.path / 'gradebook.db'}") as book:
        assert book.find_submission("lab_1_2", "ada").timestamp == datetime(2025, 10, 3, 14)
        assert book.find_submission("lab_1_2", "ben").timestamp is None
    assert any("ben/lab_1_2" in notice and "timestamp.txt" in notice for notice in report.notices)


def test_a_file_without_a_place_takes_no_time_from_an_exchange(klass: TinyClass, tmp_path: Path) -> None:
    there = klass.submit("ben").with_name("timestamp.txt")
    there.write_text("2025-10-03 14:00:00.000000 UTC")
    stranger = write_zip(tmp_path / "c.zip", {"nobody_999_9001_lab_1_2.ipynb": work(klass, 3)})
    assert [one.state for one in collect(klass.path, [stranger], zone=ZoneInfo("UTC")).outcomes] == [
        LineState.NOT_PLACED
    ]
    assert read_timestamp(there.parent) == there.read_text()
    assert not is_not_believed(there.parent)


# -- hostile archives
# -----------------------------------------------------------------------------------------------


def outside(path: Path) -> set[str]:
    return {str(p.relative_to(path)) for p in path.rglob("*") if ".autograder" not in p.parts}


def test_names_that_lead_out_and_links_go_nowhere(klass: TinyClass, tmp_path: Path) -> None:
    link = zipfile.ZipInfo("Ben Bär_3_assignsubmission_file_lab_1_2.ipynb")
    link.external_attr = 0o120777 << 16
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("../../Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb", work(klass))
        archive.writestr("/tmp/Eve O'Neill_1_assignsubmission_file_lab_1_2.ipynb", work(klass))
        archive.writestr("C:\\Zoë Zuse_1_assignsubmission_file_lab_1_2.ipynb", work(klass))
        archive.writestr(link, "/etc/passwd")
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "m.zip").write_bytes(data.getvalue())
    before = outside(tmp_path)
    report = collect(klass.path, [tmp_path / "in" / "m.zip"])
    assert placed(report).keys() == {"ada"}, "the folders above it are nothing but a name"
    assert "the file is a link" in why(report)
    there = {path for path in outside(tmp_path) - before if not path.startswith("class/submitted")}
    assert there <= {"class/students.csv", "class/collected.csv"}
    folder = tmp_path / "Ada Lovelace_1_assignsubmission_file"
    folder.mkdir()
    (folder / "lab_1_2.ipynb").symlink_to("/etc/passwd")
    assert "is a link" in why(collect(klass.path, [folder.parent], form="moodle"))
    assert lies(klass, "ada") == work(klass)


def test_a_bomb_is_harmless(klass: TinyClass, tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb", b" " * 60_000_000)
    assert "the limit is 50 MB" in why(collect(klass.path, [bomb]))
    # One that lies about its size: the list says 10 bytes.
    data = bytearray(bomb.read_bytes())
    place = data.rfind(b"PK\x01\x02")
    struct.pack_into("<I", data, place + 24, 10)
    bomb.write_bytes(data)
    report = collect(klass.path, [bomb])
    assert report.having(LineState.PLACED) == ()
    assert report.having(LineState.NOT_PLACED)
    inner = zipped({"a/lab_1_2.ipynb": bomb.read_bytes(), "again.zip": bomb.read_bytes()})
    report = collect(
        klass.path, [write_zip(tmp_path / "n.zip", {"Ada Lovelace_1_assignsubmission_file_x.zip": inner})]
    )
    assert {one.student for one in report.having(LineState.PLACED)} <= {"ada"}, (
        "what is no notebook is graded as such"
    )


@pytest.mark.parametrize(
    "outer",
    [
        "Ben Bär - work.zip",
        "Ben Bär_3_assignsubmission_file_work.zip",
        "Guest User - work.zip",
        "Guest User_3_assignsubmission_file_/work.zip",
        "ben/work.zip",
        "guest/work.zip",
    ],
)
def test_what_lies_in_a_students_own_zip_never_says_whose_it_is(
    klass: TinyClass, tmp_path: Path, outer: str
) -> None:
    names = (
        "Ada Lovelace - lab_1_2.ipynb",
        "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb",
        "ada/lab_1_2.ipynb",
        "x-submissions/x-adalove/lab_1_2.ipynb",
    )
    inner = zipped(dict.fromkeys(names, work(klass)))
    report = collect(
        klass.path, [write_zip(tmp_path / "d.zip", {outer: inner, "zoe/lab_1_2.ipynb": work(klass)})]
    )
    assert {one.student for one in report.having(LineState.PLACED)} <= {"ben", "zoe"}
    assert not (klass.path / "submitted" / "ada").exists()


def test_folders_with_students_ids_or_names_are_taken_and_deeper_ones_say_nothing(
    klass: TinyClass, tmp_path: Path
) -> None:
    one = work(klass)
    names = ("ada/lab_1_2/lab_1_2.ipynb", "Ben Bär/lab_1_2.ipynb", "guest/zoe/lab_1_2.ipynb")
    report = collect(klass.path, [write_zip(tmp_path / "p.zip", dict.fromkeys(names, one))])
    assert placed(report).keys() == {"ada", "ben"}
    assert [other.label for other in report.having(LineState.NOT_PLACED)] == ["p.zip/guest/zoe/lab_1_2.ipynb"]


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_every_method_that_python_knows_is_unpacked(klass: TinyClass, tmp_path: Path, method: int) -> None:
    member = "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb"
    with zipfile.ZipFile(tmp_path / "m.zip", "w", method) as archive:
        archive.writestr(member, work(klass))
    inner = {"Ben Bär_2_assignsubmission_file_lab.zip": (tmp_path / "m.zip").read_bytes()}
    report = collect(klass.path, [tmp_path / "m.zip", write_zip(tmp_path / "n.zip", inner)])
    assert placed(report).keys() == {"ada", "ben"}


def test_what_unpacks_to_gigabytes_is_held_as_small_as_it_came(klass: TinyClass, tmp_path: Path) -> None:
    """16 kB, handed in by one student, took 4 GB of the grader's memory with files of 49 MB."""
    inner = zipped({f"{number}/lab_1_2.ipynb": b" " * 4_000_000 for number in range(10)})
    files = {f"Ben Bär_2_assignsubmission_file_/{number}.zip": inner for number in range(4)}
    files["Ada Lovelace_1_assignsubmission_file_/lab_1_2.ipynb"] = work(klass).encode()
    download = write_zip(tmp_path / "d.zip", files)
    tracemalloc.start()
    try:
        assert placed(collect(klass.path, [download])).keys() == {"ada"}
        assert tracemalloc.get_traced_memory()[1] < 40_000_000
    finally:
        tracemalloc.stop()


def test_no_students_name_takes_the_place_of_anothers_record(tiny: TinyClass, tmp_path: Path) -> None:
    """Without students.csv students have the names that they gave themselves: one is called as ada's record was."""
    for number in (1, 2):
        name = f"Lab_{{}}_attempt_2025-10-0{number}-14-00-00_lab_1_2.ipynb"
        files = {name.format(who): work(tiny, number) for who in ("ada", "ada.json", "ada.kept")}
        archive = write_zip(tmp_path / f"{number}.zip", files)
        report = collect(tiny.path, [archive])
        assert placed(report).keys() == {"ada", "ada.json", "ada.kept"}


@pytest.mark.parametrize("damage", ["cut", "list", "crc", "text", "encrypted"])
def test_a_damaged_archive_is_one_line(klass: TinyClass, tmp_path: Path, damage: str) -> None:
    name = "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb"
    data = bytearray(zipped({name: work(klass)}))
    end = data.rfind(b"PK\x05\x06")
    if damage == "cut":
        data = data[: end - 5]
    elif damage == "list":
        struct.pack_into("<I", data, end + 12, 0xF0000000)
    elif damage == "crc":
        data[60] ^= 0xFF
    elif damage == "text":
        data = bytearray(b"no zip at all")
    else:
        place = data.rfind(b"PK\x01\x02")
        data[place + 8] |= 1
    (tmp_path / "m.zip").write_bytes(data)
    report = collect(klass.path, [tmp_path / "m.zip"])
    assert report.having(LineState.PLACED) == ()
    assert len(report.having(LineState.NOT_PLACED)) == 1
    if damage == "encrypted":
        assert "encrypted" in why(report)


def test_a_student_id_cannot_lead_out(tiny: TinyClass, tmp_path: Path) -> None:
    for name in ("..", "a/b", ".", "*"):
        (tiny.path / "students.csv").write_text(f"id\n{name}\n")
        if name == "..":
            archive = write_zip(tmp_path / "m.zip", {".._1_assignsubmission_file_lab_1_2.ipynb": work(tiny)})
        with pytest.raises(GradingError, match="line 2"):
            collect(tiny.path, [archive])


# -- roster and command line
# ----------------------------------------------------------------------------------------


def test_without_a_list_of_students_folders_have_the_names_of_the_lms(
    tiny: TinyClass, tmp_path: Path
) -> None:
    report = collect(
        tiny.path,
        [write_zip(tmp_path / "c.zip", {"lovelaceada_101_9001_lab_1_2.ipynb": work(tiny)})],
    )
    assert placed(report).keys() == {"lovelaceada"}
    assert (
        "the class has no students.csv, so students' folders have the names that the LMS uses" in report.notes
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name\nada\n", "no column named id"),
        ("id\nada\nada\n", "also stands in line 2"),
        ("id,email\n,a@b\n", "it has no id"),
    ],
)
def test_a_roster_that_cannot_be_used_says_why(
    tiny: TinyClass, tmp_path: Path, text: str, words: str
) -> None:
    (tiny.path / "students.csv").write_text(text)
    with pytest.raises(GradingError, match=words):
        collect(tiny.path, [write_zip(tmp_path / "m.zip", {})])


def test_a_roster_with_semicolons_and_a_mark_is_read(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text("\ufeffID;First_Name;Last_Name\r\nada;Ada;Lovelace\r\n")
    report = collect(
        tiny.path,
        [write_zip(tmp_path / "m.zip", {"Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb": work(tiny)})],
    )
    assert placed(report).keys() == {"ada"}


def test_the_roster_is_in_the_table(klass: TinyClass, fake_engine: FakeEngine) -> None:
    klass.submit("ada", 4)
    report = klass.grade()
    found: dict[str, Any] = {row.student: (row.name, row.state) for row in report.rows}
    assert found["zoe"] == ("Zoë Zuse", "not_submitted")
    assert found["ada"] == ("Ada Lovelace", "passed")
    assert set(found) == {"ada", "ben", "jose", "eve", "zoe"}


def test_the_command_says_everything(klass: TinyClass, tmp_path: Path) -> None:
    archive = write_zip(
        tmp_path / "c.zip",
        {"lovelaceada_LATE_101_9001_lab_1_2.ipynb": work(klass), "guest_999_9002_lab_1_2.ipynb": work(klass)},
    )
    result = CliRunner().invoke(cli, ["collect", str(klass.path), str(archive)])
    assert result.exit_code == 2, result.output
    assert "placed       ada/lab_1_2" in result.output
    assert "late according to the LMS" in result.output
    assert (
        "not placed   c.zip/guest_999_9002_lab_1_2.ipynb: no student in the class is called guest"
        in result.output
    )
    assert "nothing of   lab_1_2: ben, eve, jose, zoe" in result.output
    for arguments in (
        ["nowhere.zip"],
        [str(archive), "--assignment", "x"],
        [str(archive), "--timezone", "../x"],
    ):
        assert CliRunner().invoke(cli, ["collect", str(klass.path), *arguments]).exit_code == 2
    with pytest.raises(GradingError, match="There is no nowhere"):
        collect(klass.path, [Path("nowhere.zip")])


def test_a_terminal_without_utf_8_collects_the_same(klass: TinyClass, tmp_path: Path) -> None:
    archive = write_zip(tmp_path / "m.zip", {"José Núñez_7_assignsubmission_file_lab_1_2.ipynb": work(klass)})
    command = [sys.executable, "-m", "autograder", "collect", str(klass.path), str(archive)]
    (klass.path / "students.csv").unlink()
    environ = {**os.environ, "PYTHONUTF8": "0", "LC_ALL": "C"}
    done = subprocess.run(command, env=environ, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b""), done
    assert "José" in done.stdout.decode()
    assert [path.name for path in (klass.path / "submitted").iterdir()] == ["José Núñez"]


def test_times_of_a_download_are_in_the_zone_of_the_class(klass: TinyClass, tmp_path: Path) -> None:
    klass.configure('c.NbGraderAPI.timezone = "Europe/Berlin"')
    name = "Lab_ada_attempt_2025-07-01-14-00-00_lab_1_2.ipynb"
    report = collect(klass.path, [write_zip(tmp_path / "b.zip", {name: work(klass)})])
    assert report.having(LineState.PLACED)[0].when == datetime(2025, 7, 1, 12, tzinfo=UTC)


def test_the_time_is_kept_in_utc(klass: TinyClass, tmp_path: Path) -> None:
    report = collect(
        klass.path,
        [write_zip(tmp_path / "b.zip", {"Lab_ada_attempt_2025-07-01-14-00-00_lab_1_2.ipynb": work(klass)})],
        zone=BERLIN,
    )
    assert report.having(LineState.PLACED)[0].when == datetime(2025, 7, 1, 12, tzinfo=UTC)
    assert os.sep not in report.having(LineState.PLACED)[0].student
