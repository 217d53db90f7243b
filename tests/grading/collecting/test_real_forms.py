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

Sakai: scripts in public repositories look for ``Last, First(login)/Submission attachment(s)/`` and read ``grades.csv``.
Moodle's worksheets in other languages: the column names are those of Moodle's language packs.

From memory: the folders of ILIAS, the names of Google Classroom's files and of GitHub Classroom's folders.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import read_path

from autograder.grading.collecting.downloaded_files import read_list
from autograder.grading.collecting.systems import NAME_FORMS
from autograder.grading.table.students_csv import read_students_csv
from tests.cases import cases

if TYPE_CHECKING:
    from tiny_class import TinyClass

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


@pytest.mark.parametrize("system", NAME_FORMS)
def test_the_samples_of_each_row_are_read_by_this_row_and_by_no_other(system: str) -> None:
    assert NAME_FORMS[system].samples
    for sample in NAME_FORMS[system].samples:
        readers = [one.system for one in NAME_FORMS.values() if read_path(sample.split("/"), one.system)]
        assert [one for one in readers if one == system or not NAME_FORMS[one].needs_from] == [system]
