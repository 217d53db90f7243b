"""Names as learning management systems really make them say whose a file is, and a student's own names never do."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import pytest
from click.testing import CliRunner
from downloads import ROSTER, read_path, write_zip, zipped
from test_collect import lies, placed, stamp, why, work

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.new_classes.new_class import release

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.collecting.collect import CollectReport

UTC = ZoneInfo("UTC")

NOT_THIS = (
    "the file is the notebook of lab_1_3, not of lab_1_2; to collect the file for lab_1_3, write lab_1_3 under "
    "assignment in collected.csv"
)


@pytest.fixture
def klass(tiny: TinyClass) -> TinyClass:
    """A tiny class with a roster, in which one student's user name has an underscore."""
    (tiny.path / "students.csv").write_text(
        ROSTER + "a_b,Al,Berg,al@uni.example,106,al-berg\nlena,Anna-Lena,Meyer,lena@uni.example,107,\n",
        encoding="utf-8",
    )
    return tiny


def gather(klass: TinyClass, folder: Path, *names: str, **options: object) -> CollectReport:
    """Collect a download in which each of these files is the same notebook."""
    archive = write_zip(folder / "download.zip", dict.fromkeys(names, work(klass)))
    return collect(klass.path, [archive], zone=UTC, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("date", "time"),
    [
        ("Oct 3, 2025 205 PM", "2025-10-03 14:05"),
        ("October 3, 2025 2:05 PM", "2025-10-03 14:05"),
        ("Sept. 3, 2025 1205 AM", "2025-09-03 00:05"),
        ("3 October, 2025 1405", "2025-10-03 14:05"),
        ("3 October 2025 205 PM", "2025-10-03 14:05"),
        ("3 Oct. 2025 905", "2025-10-03 09:05"),
        ("13 October, 2025 105 p.m.", "2025-10-13 13:05"),
    ],
)
@pytest.mark.parametrize(
    "name", ["{} - Eve O'Neill - {}/lab_1_2.ipynb", "{} - Eve O'Neill - {} - lab_1_2.ipynb"]
)
def test_brightspace_writes_dates_as_the_country_does_in_folders_and_in_files(
    name: str, date: str, time: str
) -> None:
    parts = tuple(name.format("12345-67890", date).split("/"))
    found = read_path(parts, "brightspace")
    assert found is not None
    assert (found.identity.name, found.file) == ("Eve O'Neill", "lab_1_2.ipynb")
    assert found.when == datetime.fromisoformat(time)


def test_brightspace_may_have_the_students_own_number_in_front(klass: TinyClass, tmp_path: Path) -> None:
    with (klass.path / "students.csv").open("a", encoding="utf-8") as students:
        students.write("n0123456,Mary-Ann,Smith,ma@uni.example,108,\n")
    name = "12345-67890 - N0123456 - Mary-Ann Smith- 3 October, 2025 205 PM - lab_1_2.ipynb"
    assert placed(gather(klass, tmp_path, name)) == {}
    report = gather(klass, tmp_path, name, names="{any} - {id} - {name}- {time} - {file}")
    assert placed(report).keys() == {"n0123456"}
    assert stamp(klass, "n0123456") == "2025-10-03 14:05:00.000000 UTC"


def test_what_students_call_their_files_in_google_classroom_says_nothing(
    klass: TinyClass, tmp_path: Path
) -> None:
    report = gather(
        klass,
        tmp_path,
        "Classroom/Robotics/Lab 1.2/lab_1_2.ipynb",
        "Classroom/Robotics/Lab 1.2/lab_1_2 (1).ipynb",
        "Ada_Lovelace/lab_1_2.ipynb",  # as programs do that fetch the work through Classroom's API
    )
    assert placed(report).keys() == {"ada"}
    assert why(report).count("the file's name does not identify a student") == 2


def test_a_time_that_nobody_can_read_is_a_cell_to_write(klass: TinyClass, tmp_path: Path) -> None:
    name = "12345-67890 - Ada Lovelace - 3 vendémiaire 2025 14h05 - lab_1_2.ipynb"
    report = gather(klass, tmp_path, name)
    assert placed(report).keys() == {"ada"}
    assert report.untimed == {"lab_1_2": ("ada",)}
    said = CliRunner().invoke(cli, ["collect", str(klass.path), str(tmp_path / "download.zip")])
    assert "write the time under handed_in in collected.csv" in said.output
    assert said.exit_code == 0, "it is placed"


def test_moodle_puts_the_group_in_front(klass: TinyClass, tmp_path: Path) -> None:
    report = gather(
        klass,
        tmp_path,
        "Group A-Ada Lovelace_12345_assignsubmission_file_lab_1_2.ipynb",
        "Group 1-b-Anna-Lena Meyer_12346_assignsubmission_file_lab_1_2.ipynb",
        "Default group-José Núñez_12347_assignsubmission_file/lab_1_2.ipynb",
    )
    assert not why(report)
    assert placed(report).keys() == {"ada", "lena", "jose"}


def test_a_group_of_moodles_with_a_students_name_is_not_that_student(
    klass: TinyClass, tmp_path: Path
) -> None:
    report = gather(klass, tmp_path, "Ada Lovelace-Ben Bär_1_assignsubmission_file_lab_1_2.ipynb")
    assert placed(report).keys() == {"ben"}


def test_blackboards_user_names_may_have_an_underscore(klass: TinyClass, tmp_path: Path) -> None:
    name = "Lab_1.2_{}_attempt_2025-10-03-14-05-06_lab_1_2.ipynb"
    report = gather(klass, tmp_path, name.format("a_b"), name.format("ada"))
    assert placed(report).keys() == {"a_b", "ada"}
    (klass.path / "students.csv").write_text("id\nb\na_b\n")
    report = gather(klass, tmp_path, name.format("a_b"))
    assert {one.student for one in report.having(LineState.PLACED)} <= {"a_b"}


def test_google_names_the_student_first(klass: TinyClass, tmp_path: Path) -> None:
    folder = "Takeout/Drive/Classroom/Robotics/Lab 1.2"
    report = gather(
        klass,
        tmp_path,
        f"{folder}/Ada Lovelace - lab_1_2.ipynb",
        f"{folder}/Zoë Zuse - Copy of lab_1_2 (2).ipynb",
        names="{any}/{any}/{any}/{any}/{any}/{name} - {file}",
    )
    assert not why(report)
    assert placed(report).keys() == {"ada", "zoe"}
    report = gather(klass, tmp_path, "Lab 1.2/jose@uni.example - lab_1_2.ipynb", names="{email} - {file}")
    assert placed(report).keys() == {"jose"}
    report = gather(klass, tmp_path, "Drive/lab_1_2 - Eve O'Neill.ipynb", names="{file} - {name}")
    assert placed(report).keys() == {"eve"}, "as it called copies that it made itself"


@pytest.mark.parametrize(
    ("folder", "pattern"),
    [
        ("lab-1-2-submissions/lab-1-2-{}", "{any}/lab-1-2-{github}"),  # gh classroom clone student-repos
        ("lab-1-2-10-03-2025-02-05-06/{}", ""),  # Classroom Assistant
        ("lab-1-2-{}", "lab-1-2-{github}"),  # the repositories, zipped together
        ("lab-1-2-{}-main", "lab-1-2-{github}-main"),  # GitHub's Download ZIP
    ],
)
def test_github_calls_folders_in_several_ways(
    klass: TinyClass, tmp_path: Path, folder: str, pattern: str
) -> None:
    names = [
        f"{folder.format(login)}/chapters/ros/lab_1_2.ipynb" for login in ("adalove", "zz-top", "al-berg")
    ]
    report = gather(klass, tmp_path, *names, names=pattern)
    assert not why(report)
    assert placed(report).keys() == {"ada", "zoe", "a_b"}


def test_github_tells_who_a_login_is_by_the_grades(klass: TinyClass, tmp_path: Path) -> None:
    grades = tmp_path / "grades.csv"
    grades.write_text("github_username,roster_identifier\nbenny-b,ben@uni.example\n")
    archive = write_zip(tmp_path / "c.zip", {"lab-1-2-benny-b/lab_1_2.ipynb": work(klass)})
    assert placed(collect(klass.path, [archive, grades], names="lab-1-2-{github}")).keys() == {"ben"}


# -- what a student can choose
# ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [
        "Lab_ada_attempt_2025-10-03-14-05-06_x_ben_attempt_2025-10-04-14-05-06_lab_1_2.ipynb",
        "1-2 - Ada Lovelace - Oct 3, 2025 205 PM - 1-2 - Ben Bär - Oct 4, 2025 205 PM - lab_1_2.ipynb",
        "1-2 - Ada Lovelace - Oct 3, 2025 205 PM/1-2 - Ben Bär - Oct 4, 2025 205 PM - lab_1_2.ipynb",
        "Ada Lovelace_1_assignsubmission_file_Ben Bär_2_assignsubmission_file_lab_1_2.ipynb",
        "Ada Lovelace - Ben Bär - lab_1_2.ipynb",
    ],
)
def test_a_name_within_a_name_is_the_students_own(klass: TinyClass, tmp_path: Path, name: str) -> None:
    names = "{name} - {file}" if name.startswith("Ada Lovelace - ") else ""
    assert placed(gather(klass, tmp_path, name, names=names)).keys() == {"ada"}


@pytest.mark.parametrize(
    "name",
    [
        "Ben Bär - lab_1_2.ipynb",
        "bärben_102_9002_lab_1_2.ipynb",
        "Ben Bär_2_assignsubmission_file_lab_1_2.ipynb",
        "Lab_ben_attempt_2025-10-03-14-05-06_lab_1_2.ipynb",
    ],
)
@pytest.mark.parametrize("others", [(), ("eve/lab_1_2.ipynb", "zoe/lab_1_2.ipynb")])
def test_in_a_folder_with_a_students_id_the_files_name_says_nothing_of_others(
    klass: TinyClass, tmp_path: Path, name: str, others: tuple[str, ...]
) -> None:
    report = gather(klass, tmp_path, f"ada/{name}", *others)
    assert "ben" not in placed(report)
    assert placed(report).keys() >= {"ada"}


# -- a whole course in a zip
# ------------------------------------------------------------------------------------------


def add_assignment(klass: TinyClass, name: str) -> None:
    """A second assignment, with the same cells."""
    path = klass.path / "source" / name / f"{name}.ipynb"
    path.parent.mkdir()
    path.write_bytes((klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb").read_bytes())
    release(ClassDirectory(klass.path))


@pytest.mark.parametrize("assignment", ["", "lab_1_2"])
def test_of_a_zip_of_the_whole_course_each_notebook_is_itself(
    klass: TinyClass, tmp_path: Path, assignment: str
) -> None:
    add_assignment(klass, "lab_1_3")
    right, other = work(klass, 3), work(klass, 4)
    inner = zipped({"course/lab_1_2 (1).ipynb": right, "course/lab_1_3.ipynb": other, "course/a.txt": "x"})
    names = {"Ada Lovelace_12345_assignsubmission_file_course.zip": inner}
    report = collect(klass.path, [write_zip(tmp_path / "m.zip", names)], assignment=assignment)
    assert not why(report)
    assert lies(klass, "ada") == right
    third = klass.path / "submitted" / "ada" / "lab_1_3" / "lab_1_3.ipynb"
    assert third.exists() is (assignment == "")
    beside = [one.reason for one in report.having(LineState.BESIDE) if not one.label.endswith("a.txt")]
    assert beside == ([NOT_THIS] if assignment else [])


def test_what_the_instructor_says_counts_where_nothing_else_does(klass: TinyClass, tmp_path: Path) -> None:
    add_assignment(klass, "lab_1_3")
    name = "Ada Lovelace_1_assignsubmission_file_{}.ipynb"
    report = gather(klass, tmp_path, name.format("homework"), assignment="lab_1_2")
    assert [(one.student, one.assignment) for one in report.having(LineState.PLACED)] == [("ada", "lab_1_2")]
    report = gather(klass, tmp_path, name.format("lab_1_3"), assignment="lab_1_2")
    (beside,) = report.having(LineState.BESIDE)
    assert "the file is the notebook of lab_1_3, not of lab_1_2" in beside.reason


def test_a_flat_brightspace_download_has_times_too(klass: TinyClass, tmp_path: Path) -> None:
    gather(
        klass,
        tmp_path,
        "12345-67890 - Ada Lovelace - 3 October, 2025 1405 - lab_1_2.ipynb",
        "12346-67890 - Ben Bär - 4 October, 2025 905 - lab_1_2 (1).ipynb",
    )
    assert stamp(klass, "ada") == "2025-10-03 14:05:00.000000 UTC"
    assert stamp(klass, "ben") == "2025-10-04 09:05:00.000000 UTC"
