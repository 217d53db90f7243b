"""Files of a download that an instructor names one by one, as with ``download/*``: each is one student's own work."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip, zipped
from test_collect import lies, placed, why, work

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import CollectedRecords, LineState
from autograder.grading.grading_errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass


def test_a_students_zip_is_no_download_whose_names_are_believed(klass: TinyClass, tmp_path: Path) -> None:
    """Ada's zip holds a file that is called as Canvas calls a newer one of Ben's."""
    forged = {"barben_102_99999_lab_1_2.ipynb": work(klass, 1), "lab_1_2.ipynb": work(klass, 2)}
    (tmp_path / "lovelaceada_101_9001_work.zip").write_bytes(zipped(forged))
    (tmp_path / "barben_102_9002_lab_1_2.ipynb").write_text(work(klass, 3))
    report = collect(klass.path, sorted(tmp_path.glob("*_9*")))
    assert placed(report).keys() == {"ada", "ben"}
    assert (lies(klass, "ada"), lies(klass, "ben")) == (work(klass, 2), work(klass, 3))
    assert not any("99999" in one.label for one in report.outcomes if one.student == "ben")


@pytest.mark.parametrize("has_list", [True, False])
def test_a_zip_of_somebody_unknown_is_no_download_either(
    tiny: TinyClass, tmp_path: Path, *, has_list: bool
) -> None:
    """Eve's name is in no list; without any list, each name of the system's is a student's."""
    if has_list:
        (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    forged = zipped({"barben_102_99999_lab_1_2.ipynb": work(tiny, 1)})
    (tmp_path / "malloryeve_666_9001_work.zip").write_bytes(forged)
    (tmp_path / "malloryeve_666_9004_list.csv").write_text(
        "user_id,submitted_at,login_id\n102,2030-01-01T12:00:00Z,ben\n"
    )
    (tmp_path / "barben_102_9002_lab_1_2.ipynb").write_text(work(tiny, 3))
    report = collect(tiny.path, sorted(tmp_path.glob("*_9*")))
    ben = "ben" if has_list else "barben"
    assert lies(tiny, ben) == work(tiny, 3)
    assert placed(report).keys() == ({ben} if has_list else {ben, "malloryeve"})
    assert not has_list or "no student in the class is called malloryeve" in why(report)


def test_what_is_called_after_a_student_is_that_students(klass: TinyClass, tmp_path: Path) -> None:
    """Zips and notebooks that came by mail."""
    forged = {"barben_102_99999_lab_1_2.ipynb": work(klass, 1), "lab_1_2.ipynb": work(klass, 2)}
    (tmp_path / "ada.zip").write_bytes(zipped(forged))
    (tmp_path / "Ben Bär.ipynb").write_text(work(klass, 3))
    (tmp_path / "josen.zip").write_bytes(zipped({"lab-1-2-josen-main/lab_1_2.ipynb": work(klass)}))
    report = collect(klass.path, sorted(tmp_path.glob("*.*")))
    assert placed(report).keys() == {"ada", "ben", "jose"}
    assert lies(klass, "ada") == work(klass, 2)
    assert report.notes == ()


def test_a_file_is_the_work_of_the_student_whom_the_instructor_names(
    klass: TinyClass, tmp_path: Path
) -> None:
    """No name says whose the zip is, and the one inside is Ben's: the instructor says that it is Ada's."""
    files = {"barben_102_9002_lab_1_2.ipynb": work(klass, 3)}
    download = write_zip(tmp_path / "homework.zip", files)
    report = collect(klass.path, [download], student="ada")
    assert (placed(report).keys(), report.notes) == ({"ada"}, ())
    with pytest.raises(GradingError, match="No student is named adda"):
        collect(klass.path, [download], student="adda")


def test_drives_own_name_of_an_archive_is_no_students(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    files = {f"Lab/{student} - lab_1_2.ipynb": work(tiny, 1) for student in ("Ada Lovelace", "Ben Bär")}
    download = write_zip(tmp_path / "ROS 2 - Lab-20251003T140506Z-1-001.zip", files)
    report = collect(tiny.path, [download], names="{name} - {file}")
    assert placed(report).keys() == {"ada", "ben"}


def test_an_archive_of_which_nothing_is_taken_has_a_line(klass: TinyClass, tmp_path: Path) -> None:
    archive = zipped({"__MACOSX/._lab_1_2.ipynb": "x", ".DS_Store": "y"})
    (tmp_path / "ada").mkdir()
    (tmp_path / "ada" / "work.zip").write_bytes(archive)
    report = collect(klass.path, [tmp_path / "ada"])
    assert [one.student for one in report.having(LineState.NOT_PLACED)] == ["ada"]
    assert "the archive contains no file, or only files that programs leave there" in why(report)


def test_a_students_table_is_no_list_of_the_instructors(klass: TinyClass, tmp_path: Path) -> None:
    """Ada's table says that Ben handed in years later, and that what has her number is his."""
    table = "user_id,submitted_at,login_id\n102,2030-01-01T00:00:00Z,ben\n101,2020-01-01T00:00:00Z,ben\n"
    (tmp_path / "lovelaceada_101_9001_grades.csv").write_text(table)
    (tmp_path / "lovelaceada_101_9003_lab_1_2.ipynb").write_text(work(klass, 2))
    (tmp_path / "barben_102_9002_lab_1_2.ipynb").write_text(work(klass, 3))
    report = collect(klass.path, sorted(tmp_path.glob("*_9*")))
    assert placed(report).keys() == {"ada", "ben"}
    history = CollectedRecords(klass.path / ".autograder").get("lab_1_2", "ben")
    assert history is not None
    assert history.when is None
    (beside,) = report.having(LineState.BESIDE)
    assert (beside.student, beside.reason) == ("ada", "it is not a notebook")


def test_a_download_and_a_list_are_still_what_they_are(klass: TinyClass, tmp_path: Path) -> None:
    files = {"barben_102_9002_lab_1_2.ipynb": work(klass, 3)}
    (tmp_path / "Grades - CS_101.csv").write_text(
        "user_id,login_id,submitted_at\n102,ben,2025-01-01T00:00Z\n"
    )
    sources = [
        write_zip(tmp_path / "cs_7_2-lab-1-2 submissions.zip", files),
        tmp_path / "Grades - CS_101.csv",
    ]
    report = collect(klass.path, sources)
    assert placed(report).keys() == {"ben"}
    assert report.having(LineState.PLACED)[0].when is not None


def test_who_is_in_no_list_cannot_have_names_read_as_another_systems(
    klass: TinyClass, tmp_path: Path
) -> None:
    """Of repositories, the one of a student whom nobody knows by that name holds many files of Canvas's form."""
    files = {f"lab/{student}/lab_1_2.ipynb": work(klass, 3) for student in ("ada", "eve", "zoe")}
    files |= {f"lab/stranger/barben_102_{number}_lab_1_2.ipynb": work(klass, 1) for number in range(9)}
    report = collect(klass.path, [write_zip(tmp_path / "repositories.zip", files)])
    assert placed(report).keys() == {"ada", "eve", "zoe"}
    assert len(report.having(LineState.NOT_PLACED)) == 9


@pytest.mark.parametrize("form", ["lab-1-2-{}", "lab-1-2-submissions/lab-1-2-{}"])
@pytest.mark.parametrize("login", ["x-adalove", "adalove-1"])
def test_no_login_that_ends_as_anothers_has_the_others_work_replaced(
    klass: TinyClass, tmp_path: Path, form: str, login: str
) -> None:
    """Who takes such a login, which is in no list, and numbers the notebook, would hand in for Ada."""
    folders = {"adalove": "lab_1_2.ipynb", login: "lab_1_2 (9).ipynb", "josen": "lab_1_2.ipynb"}
    for place, (who, name) in enumerate(folders.items()):
        folder = tmp_path / "repositories" / form.format(who)
        folder.mkdir(parents=True)
        (folder / name).write_text(work(klass, place))
    report = collect(klass.path, [tmp_path / "repositories"], names=form.format("{github}"))
    assert (placed(report).keys(), lies(klass, "ada")) == ({"ada", "jose"}, work(klass, 0))
    assert report.exit_code == 2


@pytest.mark.parametrize(
    "names",
    [
        ("lovelaceada_101_9001_lab_1_2.ipynb", "lovelaceada_999_9999_lab_1_2.ipynb"),
        (
            "Ada Lovelace_1_assignsubmission_file_/lab_1_2.ipynb",
            "Ada Lovelace_2_assignsubmission_file_/lab_1_2 (9).ipynb",
        ),
    ],
)
def test_who_is_called_as_another_hands_in_nothing_for_the_other(
    tiny: TinyClass, tmp_path: Path, names: tuple[str, str]
) -> None:
    """In some systems one may change one's name: without the system's ids, both are read as Ada's."""
    (tiny.path / "students.csv").write_text("id,first_name,last_name\nada,Ada,Lovelace\neve,Eve,Mallory\n")
    download = write_zip(tmp_path / "m.zip", {name: work(tiny, place) for place, name in enumerate(names)})
    report = collect(tiny.path, [download])
    assert placed(report) == {}
    assert [one.student for one in report.having(LineState.NOT_PLACED)] == ["ada", "ada"]
    assert "several people in the LMS have the name of ada" in why(report)
    if "101" in names[0]:
        (tiny.path / "students.csv").write_text(
            "id,first_name,last_name,canvas\nada,Ada,Lovelace,101\neve,,,999\n"
        )
        assert placed(collect(tiny.path, [download])).keys() == {"ada", "eve"}


BLACKBOARDS = "malloryeve_LATE_104_5003_x_{}_attempt_2025-12-31-00-00-00_lab_1_2.ipynb"
"""A file's name of Canvas's, whose end, which its student has chosen, looks like one of Blackboard's."""


def test_a_name_that_two_systems_may_have_given_to_two_students_is_refused(
    klass: TinyClass, tmp_path: Path
) -> None:
    (klass.path / "students.csv").write_text("id,canvas\nada,101\nmalloryeve,104\n")
    for whose in ("ada", "malloryeve"):
        file = tmp_path / BLACKBOARDS.format(whose)
        file.write_text(work(klass, 1))
        report = collect(klass.path, [file])
        assert placed(report) == {}, whose
        meant = ", ".join(dict.fromkeys((whose, "malloryeve")))
        assert f"{file.name} may be {meant}: name its system with --from, or write" in why(report)
    assert placed(collect(klass.path, [file], form="canvas")).keys() == {"malloryeve"}


def test_no_names_that_one_student_chooses_say_which_system_a_download_is_of(
    klass: TinyClass, tmp_path: Path
) -> None:
    files = {
        "lovelaceada_101_5001_lab_1_2.ipynb": work(klass, 1),
        "barben_102_5002_lab_1_2.ipynb": work(klass, 2),
    }
    for number, whose in enumerate(("ada", "ben", "zoe")):
        name = f"oneilleve_104_600{number}_x_{whose}_attempt_2025-12-31-00-00-00_lab_1_2.ipynb"
        files[name] = work(klass, 5 + number)
    download = write_zip(tmp_path / "submissions.zip", files)
    report = collect(klass.path, [download])
    assert (lies(klass, "ada"), lies(klass, "ben")) == (work(klass, 1), work(klass, 2))
    assert placed(report).keys() == {"ada", "ben"}
    assert all(f" may be {one}, eve: name its system" in why(report) for one in ("ada", "ben", "zoe"))
    report = collect(klass.path, [download], form="canvas")
    assert {one.student for one in report.outcomes} == {"ada", "ben", "eve"}


@pytest.mark.parametrize("has_list", [True, False])
@pytest.mark.parametrize(
    "name",
    [
        "12345-67890 - {} - Oct 3, 2025 205 PM - lab_1_2.ipynb",
        "lab_1_2_{}_attempt_2025-10-03-14-05-06_lab_1_2.ipynb",
        "12345-67890 - {} - Oct 3, 2025 205 PM/{} - lab_1_2.ipynb",
    ],
)
def test_names_of_a_system_that_look_like_those_of_another_are_read_as_before(
    tiny: TinyClass, tmp_path: Path, name: str, *, has_list: bool
) -> None:
    if has_list:
        (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    who = ("ada", "eve") if "attempt" in name else ("Ada Lovelace", "Eve O'Neill")
    files = {name.format(one, one): work(tiny, place) for place, one in enumerate(who)}
    report = collect(
        tiny.path, [write_zip(tmp_path / "gradebook_ROS_lab_1_2_2025-10-03-14-05-06.zip", files)]
    )
    assert len(placed(report)) == 2
