"""The forms of names and lists as public repositories show them; each is made anew here, none is copied.

Names of files
    Canvas: github.com/mikewesthad/canvas-unzipper and github.com/TimHanneman/Canvas_submission_sort (README.md):
    name, number, number of the file, the student's own name; LATE behind the name; -1 where it came again.
    Moodle: github.com/johnhw/moodle_nbgrader (collect_files.py, update_gradesheet.py) and
    github.com/cladelpino/MoodleAssignmentScripts (GenerateFolderStructure.bat): full name, number, what kind it is.
    Gradescope: github.com/djhuffman/gradescope_renaming_files (gradescope_rename_files.py) and
    github.com/ucbds-infra/otter-grader (otter/grade/metadata.py): a file or folder for each submission, and
    submission_metadata.yml, in which each has its submitters with name, sid and email.
    Blackboard: github.com/vangef/BBGradebookOrganiser and github.com/kwurst/bb-file-cleanup (README.md): assignment,
    user name, attempt and time, the student's own name; a text file for each attempt.
    Brightspace: github.com/OfficeCoffee/GradingFileProject (ToDo.md), in which there are two samples. No second
    repository was found by name.

Columns of lists
    Canvas's gradebook: github.com/ubraket513/mylab-to-canvas-gradebook (tests/fixtures/anonymized/canvas-valid.csv),
    with a line about posting above the points, and github.com/myl7/mylmoe (docs/posts/cityu-ta-upload-canvas-grade.md).
    Canvas's submissions: github.com/upenn/gradescope-canvas-crawler (data/schemas.md); the names are those of Canvas's
    interface for programs.
    Moodle's grading worksheet: github.com/apo5698/helli-grading (app/lib/helli/csv/adapter/moodle_grading_worksheet.rb)
    and github.com/johnhw/moodle_nbgrader (collect_files.py). Day and month are in two orders.
    Moodle's participants: github.com/tonechas/moodle-workshop-group-grades (README.md) and
    github.com/jozsef-k/nbgutils (mstudent_import.py).
    Gradescope's scores: github.com/upenn/gradescope-canvas-crawler (data/schemas.md) and, of a whole course,
    github.com/matthigger/gradescope_mean (test/scope.csv). Gradescope's roster, and the
    grades of GitHub Classroom: excerpts of an index that names no repository.

From memory: the names of Google Classroom's files and of GitHub Classroom's folders.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import pytest
from downloads import ROSTER, read_path, write_zip
from test_collect import lies, stamp, why, work

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.collecting.downloaded_files import read_list
from autograder.grading.table.students_csv import read_students_csv
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

UTC = ZoneInfo("UTC")
METADATA = cases(__file__, "METADATA")


@pytest.mark.parametrize(
    ("form", "name", "who", "file"),
    cases(__file__, "a_name_says_whose_it_is"),
)
def test_a_name_says_whose_it_is(form: str, name: str, who: str, file: str) -> None:
    found = read_path(name.split("/"), form)
    assert found is not None
    assert (str(found.identity), found.file) == (who, file)
    assert found.late == ("late" in name.lower())


@pytest.mark.parametrize(
    ("name", "text", "number", "time"),
    cases(__file__, "a_list_says_who_a_number_is_and_when"),
)
def test_a_list_says_who_a_number_is_and_when(name: str, text: str, number: str, time: str) -> None:
    entries = read_list(name, text.format(time).encode())
    assert entries is not None
    (entry,) = entries
    assert entry.number == number
    assert entry.members[0]
    assert entry.when is not None
    assert f"{entry.when:%Y-%m-%d %H:%M}" == "2020-09-23 21:00"


def gradescope_export(root: str, one: str, two: str) -> dict[str, str]:
    """The list, Ada's work and Ben's."""
    return {
        f"{root}submission_metadata.yml": METADATA,
        f"{root}submission_409194023/lab_1_2.ipynb": one,
        f"{root}submission_500000001/lab_1_2.ipynb": two,
    }


def test_gradescopes_export_is_collected_with_its_times_and_groups(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text(ROSTER)
    root = "assignment_8046601_export"
    one, two = work(tiny, 1), work(tiny, 2)
    files = {
        **gradescope_export(f"{root}/", one, two),
        f"{root}/submission_600000002/lab_1_2.ipynb": two,
        f"{root}/submission_409194023/submission_metadata.yml": "the student's own",
    }
    report = collect(tiny.path, [write_zip(tmp_path / "export.zip", files)], zone=UTC)
    assert [lies(tiny, student) for student in ("ada", "ben", "jose")] == [one, two, two]
    assert stamp(tiny, "ada") == "2026-04-26 17:34:00.861687 UTC"
    assert stamp(tiny, "jose") == "2026-04-27 08:00:00.000000 UTC"
    assert why(report).startswith(
        f"export.zip/{root}/submission_600000002/lab_1_2.ipynb: no student in the class is called 333"
    )
    assert len(report.having(LineState.NOT_PLACED)) == 1


STEALS = """\
submission_409194023:
  :submitters:
  - :name: Ben Baer
    :email: ben@uni.example
  :created_at: 2026-04-28 08:00:00.000000000 Z
"""


@pytest.mark.parametrize("root", ["", "assignment_8046601_export/"])
def test_no_student_hands_in_the_list_that_says_whose_work_is_whose(
    tiny: TinyClass, tmp_path: Path, root: str
) -> None:
    """Without the folder around it the list of a student was read, and Ada's work was Ben's."""
    (tiny.path / "students.csv").write_text(ROSTER)
    one, two = work(tiny, 1), work(tiny, 2)
    files = {
        **gradescope_export(root, one, two),
        f"{root}submission_500000001/submission_metadata.yml": STEALS,
    }
    form = "" if root else "gradescope"  # its own folder says so, too
    collect(tiny.path, [write_zip(tmp_path / "export.zip", files)], zone=UTC, form=form)
    assert [lies(tiny, student) for student in ("ada", "ben")] == [one, two]
    assert stamp(tiny, "ben").startswith("2026-04-27")


def test_no_list_becomes_longer_than_it_was_typed() -> None:
    """Each line has nine times the one above: as a text the last one took all memory."""
    rows = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    rows += [f"a{number}: &a{number} [{', '.join([f'*a{number - 1}'] * 9)}]" for number in range(1, 10)]
    rows += ["submission_1:", "  :submitters:", "  - :name: *a9", "    :sid: 0x7", "    :email: 007"]
    rows += ["  :created_at: *a9"]
    entries = read_list("submission_metadata.yml", "\n".join(rows).encode())
    assert entries is not None
    (entry,) = entries
    assert [name.login for name in entry.members[0]] == ["0x7", "007"]
    assert entry.when is None


@pytest.mark.parametrize(
    ("text", "expected"),
    cases(__file__, "a_list_of_the_lms_is_a_list_of_students"),
)
def test_a_list_of_the_lms_is_a_list_of_students(
    tiny: TinyClass, text: str, expected: tuple[object, ...]
) -> None:
    (tiny.path / "students.csv").write_text(text, encoding="utf-8")
    (student,) = read_students_csv(tiny.path / "students.csv").students
    assert (student.id, student.first_name, student.last_name, student.email, student.lms) == expected


def test_two_of_one_name_in_moodle_are_told_apart_by_the_worksheet(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text(
        "id,first_name,last_name,email\nada,Ada,Lovelace,a@u.example\nada2,Ada,Lovelace,b@u.example\n"
    )
    archive = write_zip(
        tmp_path / "m.zip", {"Ada Lovelace_7_assignsubmission_file_lab_1_2.ipynb": work(tiny)}
    )
    assert "together with the grading worksheet" in why(collect(tiny.path, [archive]))
    sheet = tmp_path / "Grades.csv"
    sheet.write_text("Identifier,Full name,Email address,Grade\nParticipant 7,Ada Lovelace,b@u.example,\n")
    report = collect(tiny.path, [archive, sheet])
    assert [one.student for one in report.having(LineState.PLACED)] == ["ada2"]
