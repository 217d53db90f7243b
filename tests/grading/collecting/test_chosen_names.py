"""Names that a student has chosen are never believed, whatever she calls her files, her folders and herself."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip, zipped
from test_collect import lies, placed, why, work
from test_real_forms import METADATA, STEALS, gradescope_export
from test_submitted_file_names import add_assignment

from autograder.boxes import reading_desks
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import CollectedRecords, LineState

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

    from tiny_class import TinyClass

IN_BOTH = "mallory_777_5003_x_ben_attempt_2031-01-01-10-00-00_lab_1_2.ipynb"
"""Canvas's name of a file of somebody whom nobody knows; its end, which she chose, looks like Blackboard's."""


def folder(path: Path, files: dict[str, str]) -> Path:
    for name, content in files.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_text(content)
    return path


def when(klass: TinyClass, student: str, assignment: str = "lab_1_2") -> datetime | None:
    history = CollectedRecords(klass.path / ".autograder").get(assignment, student)
    assert history is not None
    return history.when


# -- which folders say a student
# ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize(
    ("known", "unknown"),
    [
        ("ada", "mallory"),
        ("lovelaceada_101_9001_lab_1_2", "mallory_777_5003_lab"),
    ],
)
def test_of_repositories_named_one_by_one_nothing_inside_says_whose_it_is(
    klass: TinyClass, tmp_path: Path, known: str, unknown: str, *, packed: bool
) -> None:
    """One is of somebody whom nobody knows by that name, and has a folder, a file and a list that speak of Ben."""
    mallory = {
        "ben/lab_1_2.ipynb": work(klass, 1),
        "barben_102_9009_lab_1_2.ipynb": work(klass, 2),
        "submission_500000001/lab_1_2.ipynb": work(klass, 3),
        "submission_metadata.yml": METADATA,
    }
    repositories = tmp_path / "repositories"
    folder(repositories / known, {"lab_1_2.ipynb": work(klass, 4)})
    if packed:
        write_zip(repositories / f"{unknown}.zip", mallory)
    else:
        folder(repositories / unknown, mallory)
    report = collect(klass.path, sorted(repositories.iterdir()))
    assert placed(report).keys() == {"ada"}
    assert report.exit_code == 2
    assert unknown in why(report)


def test_several_folders_beside_each_other_are_one_students_each_also_where_nobody_is_known(
    klass: TinyClass, tmp_path: Path
) -> None:
    repositories = tmp_path / "repositories"
    for name in ("lab-1-2-mallory", "lab-1-2-trudy"):
        folder(repositories / name, {"ben/lab_1_2.ipynb": work(klass, 1)})
    report = collect(klass.path, sorted(repositories.iterdir()))
    assert placed(report) == {}
    assert report.exit_code == 2


def test_who_is_known_by_a_list_alone_shows_what_the_folders_are(klass: TinyClass, tmp_path: Path) -> None:
    grades = tmp_path / "grades.csv"
    grades.write_text("github_username,roster_identifier\nzee,zoe@uni.example\n")
    folder(tmp_path / "all" / "zee", {"lab_1_2.ipynb": work(klass, 1)})
    folder(tmp_path / "all" / "mallory", {"ben/lab_1_2.ipynb": work(klass, 2)})
    collect(klass.path, [grades])
    report = collect(klass.path, [*(tmp_path / "all").iterdir()])
    assert placed(report).keys() == {"zoe"}


def test_a_list_in_a_students_folder_is_no_list_of_gradescopes(klass: TinyClass, tmp_path: Path) -> None:
    files = {"submission_409194023/lab_1_2.ipynb": work(klass, 1), "submission_metadata.yml": STEALS}
    source = folder(tmp_path / "lab-1-2-mallory", files)
    assert placed(collect(klass.path, [source])) == {}
    assert placed(collect(klass.path, [source], form="gradescope")).keys() == {"ben"}, (
        "the instructor says so"
    )


def test_a_list_that_takes_gigabytes_to_read_is_a_line_that_waits(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """50 MB of YAML took 4.6 GB of memory; now the memory of the desk ends that, and a smaller one ends it sooner."""
    monkeypatch.setattr(reading_desks, "MEMORY_BYTES", 200_000_000)
    files = gradescope_export("assignment_1_export/", work(klass, 1), work(klass, 2))
    (name,) = (name for name in files if name.endswith(".yml"))
    files[name] += "a: b\n" * 1_000_000
    report = collect(klass.path, [write_zip(tmp_path / "export.zip", files)])
    assert placed(report) == {}
    assert "submission_metadata.yml: the file is too large, or not a known list" in why(report)


@pytest.mark.parametrize("name", ["x" * 1_001, "..\\x", "a/../../x", "x/" * 600 + "x"])
def test_no_name_that_is_refused_takes_the_folder_around_all_away(
    klass: TinyClass, tmp_path: Path, name: str
) -> None:
    root = "assignment_8046601_export"
    files = gradescope_export(f"{root}/", work(klass, 1), work(klass, 2))
    with zipfile.ZipFile(tmp_path / "export.zip", "w") as archive:
        for path, content in files.items():
            archive.writestr(path, content)
        archive.writestr(f"{root}/submission_500000001/{name}", "x")
    report = collect(klass.path, [tmp_path / "export.zip"])
    assert placed(report).keys() == {"ada", "ben", "jose"}
    labels = [one.label for one in report.outcomes if "submission_500000001/lab_1_2" not in one.label]
    (refused,) = (label for label in labels if label.startswith(f"export.zip/{root}/submission_500000001/"))
    assert len(refused) < 1_200


# -- which system a name is of
# -----------------------------------------------------------------------------------------


def test_what_one_system_reads_as_nobodys_is_not_anothers_student(klass: TinyClass, tmp_path: Path) -> None:
    file = tmp_path / IN_BOTH
    file.write_text(work(klass, 1))
    report = collect(klass.path, [file])
    assert placed(report) == {}
    assert f"{IN_BOTH} may be ben: name its system with --from, or write the id" in why(report)
    assert "no student in the class is called mallory" in why(collect(klass.path, [file], form="canvas"))
    download = write_zip(tmp_path / "s.zip", {f"lab/{IN_BOTH}": work(klass), "lab/zusezoe_105_1_x.png": "x"})
    assert placed(collect(klass.path, [download])) == {}


@pytest.mark.parametrize(
    "name",
    [
        "lab_1_2_ada_attempt_2025-10-03-14-05-06_lab_1_2.ipynb",
        "Lab 10.2_ada_attempt_2025-10-03-14-05-06_lab_1_2.ipynb",
        "robotics_2025_10_submissions/Ada Lovelace_4_assignsubmission_file_/lab_1_2.ipynb",
        "lab_1_2_submissions/Ada Lovelace_5_assignsubmission_file_/x_10_20_y.ipynb",
        "12345-67890 - Ada Lovelace - Oct 3, 2025 205 PM - hw_2024_10_final.ipynb",
        "Ada Lovelace_12345_assignsubmission_file_hw_2024_10_final.ipynb",
    ],
)
@pytest.mark.parametrize("alone", [True, False])
def test_honest_names_of_one_system_are_not_read_as_anothers(
    klass: TinyClass, tmp_path: Path, name: str, *, alone: bool
) -> None:
    if alone:
        source = tmp_path / "in" / name.partition("/")[0]
        folder(tmp_path / "in", {name: work(klass)})
    else:
        source = write_zip(tmp_path / "c.zip", {name: work(klass)})
    assert placed(collect(klass.path, [source])).keys() == {"ada"}


@pytest.mark.parametrize(
    "name", ["lab_1_2_submissions.zip", "gradebook_CS_101_2_lab_2025-10-03-14-05-06.zip"]
)
def test_a_download_that_is_called_as_a_file_of_canvas_is_one(
    klass: TinyClass, tmp_path: Path, name: str
) -> None:
    files = {"Lab_ada_attempt_2025-10-03-14-05-06_lab_1_2.ipynb": work(klass)}
    assert placed(collect(klass.path, [write_zip(tmp_path / name, files)])).keys() == {"ada"}


@pytest.mark.parametrize(
    ("hers", "others"),
    [
        ("gradebook_777_5003_x_2025-10-03-14-05-06.zip", "zusezoe_105_9003_x.zip"),
        ("lab_1_2_mal_attempt_2025-10-03-14-05-06_x.zip", "lab_1_2_zoe_attempt_2025-10-03-14-05-06_x.zip"),
    ],
)
def test_beside_a_students_archive_no_name_makes_another_a_download(
    klass: TinyClass, tmp_path: Path, hers: str, others: str
) -> None:
    forged = {"Lab_ben_attempt_2025-10-03-14-05-06_lab_1_2.ipynb": work(klass)}
    sources = [
        write_zip(tmp_path / hers, forged),
        write_zip(tmp_path / others, {"lab_1_2.ipynb": work(klass)}),
    ]
    report = collect(klass.path, sources)
    assert placed(report).keys() == {"zoe"}
    assert placed(collect(klass.path, sources[:1])).keys() == ({"ben"} if "gradebook" in hers else set())


def test_googles_names_say_whose_a_file_is_only_where_the_instructor_says_so(
    klass: TinyClass, tmp_path: Path
) -> None:
    files = {"Ben Bär - lab_1_2 (9).ipynb": work(klass, 1), "ben/lab_1_2.ipynb": work(klass, 2)}
    download = write_zip(tmp_path / "d.zip", files)
    report = collect(klass.path, [download])
    assert (lies(klass, "ben"), len(placed(report))) == (work(klass, 2), 1)
    assert "--from" not in why(report)


def test_a_table_beside_files_that_students_have_named_is_no_list(klass: TinyClass, tmp_path: Path) -> None:
    collect(klass.path, [write_zip(tmp_path / "c.zip", {"barben_102_9002_lab_1_2.ipynb": work(klass)})])
    listed = "user_id,submitted_at,login_id\n102,2030-01-01T12:00:00Z,ben\n"
    files = {"Ada Lovelace - lab_1_2.ipynb": work(klass), "times.csv": listed}
    report = collect(klass.path, sorted(folder(tmp_path / "d", files).iterdir()))
    assert when(klass, "ben") is None
    assert placed(report) == {}
    collect(klass.path, [tmp_path / "d" / "times.csv"])
    assert when(klass, "ben") is not None


# -- who takes another's name
# ------------------------------------------------------------------------------------------


def test_of_files_named_one_by_one_two_people_of_one_name_are_told_apart(
    tiny: TinyClass, tmp_path: Path
) -> None:
    (tiny.path / "students.csv").write_text("id,first_name,last_name\nada,Ada,Lovelace\n")
    names = ("lovelaceada_101_9001_lab_1_2.ipynb", "lovelaceada_999_9999_lab_1_2.ipynb")
    files = folder(tmp_path / "d", {name: work(tiny, place) for place, name in enumerate(names)})
    report = collect(tiny.path, sorted(files.iterdir()))
    assert (placed(report), len(report.having(LineState.NOT_PLACED))) == ({}, 2)
    assert "several people in the LMS have the name of ada; their numbers are 101, 999" in why(report)
    (tiny.path / "students.csv").write_text("id,first_name,last_name,canvas\nada,Ada,Lovelace,101\n")
    report = collect(tiny.path)
    assert (placed(report).keys(), lies(tiny, "ada")) == ({"ada"}, work(tiny, 0))
    assert "no student in the class is called lovelaceada" in why(report)


@pytest.mark.parametrize(
    ("roster", "name"),
    [
        ("id,first_name,last_name,canvas\nada,Ada,Lovelace,101\n", "lovelaceada_999_9999_lab_1_2.ipynb"),
        ("id,blackboard\nada,al\n", "Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb"),
    ],
)
def test_who_is_known_by_a_number_is_never_meant_by_name_under_another(
    tiny: TinyClass, tmp_path: Path, roster: str, name: str
) -> None:
    (tiny.path / "students.csv").write_text(roster)
    report = collect(tiny.path, [write_zip(tmp_path / "d.zip", {name: work(tiny)})])
    assert (placed(report), report.exit_code) == ({}, 2)
    assert "no student in the class is called" in why(report)


def test_whose_number_a_list_says_is_not_held_up_by_who_takes_the_name(
    tiny: TinyClass, tmp_path: Path
) -> None:
    (tiny.path / "students.csv").write_text("id,first_name,last_name,email\nada,Ada,Lovelace,a@u.example\n")
    names = (
        "Ada Lovelace_1_assignsubmission_file_x.ipynb",
        "Ada Lovelace_2_assignsubmission_file_lab_1_2.ipynb",
    )
    download = write_zip(tmp_path / "m.zip", {name: work(tiny, place) for place, name in enumerate(names)})
    sheet = tmp_path / "Grades.csv"
    sheet.write_text("Identifier,Full name,Email address,Grade\nParticipant 1,Ada Lovelace,a@u.example,\n")
    assert placed(collect(tiny.path, [download])) == {}
    report = collect(tiny.path, [download, sheet])
    assert lies(tiny, "ada") == work(tiny, 0)
    assert "their numbers are 1, 2" in why(report)


# -- what honest instructors met
# ---------------------------------------------------------------------------------------


def test_who_hands_in_to_two_boxes_of_moodles_has_two_numbers_that_the_lists_explain(
    klass: TinyClass, tmp_path: Path
) -> None:
    names = (
        "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb",
        "Ada Lovelace_2_assignsubmission_onlinetext_lab_1_2 (1).ipynb",
    )
    sources = [write_zip(tmp_path / "m.zip", {name: work(klass, place) for place, name in enumerate(names)})]
    for number in (1, 2):
        sheet = tmp_path / f"Grades-{number}.csv"
        sheet.write_text(
            "Identifier,Full name,Email address,Grade,Last modified (submission)\n"
            f'Participant {number},Ada Lovelace,ada.love@uni.example,,"Friday, {number} October 2025, 2:05 PM"\n'
        )
        sources.append(sheet)
    report = collect(klass.path, sources)
    assert (why(report), lies(klass, "ada")) == ("", work(klass, 1))


def test_of_two_lists_of_canvas_none_says_when_the_work_of_both_assignments_came(
    klass: TinyClass, tmp_path: Path
) -> None:
    add_assignment(klass, "lab_1_3")
    (klass.path / "students.csv").write_text(ROSTER.replace("zz-top\n", "zz-top\nmia,Mia,May,,106,\n"))
    names = [
        f"{who}_{lab}.ipynb"
        for lab in ("lab_1_2", "lab_1_3")
        for who in ("barben_102_9002", "maymia_106_9003")
    ]
    sources = [write_zip(tmp_path / "c.zip", dict.fromkeys(names, work(klass)))]
    for day in (3, 4):
        sheet = tmp_path / f"{day}.csv"
        same = "106,2025-10-05T12:00:00Z"
        sheet.write_text(f"user_id,submitted_at,login_id\n102,2025-10-0{day}T12:00:00Z,ben\n{same},mia\n")
        sources.append(sheet)
    collect(klass.path, sources)
    assert [when(klass, "ben", lab) for lab in ("lab_1_2", "lab_1_3")] == [None, None]
    assert when(klass, "mia") is not None


def test_a_strangers_archive_has_one_line(klass: TinyClass, tmp_path: Path) -> None:
    archive = zipped({f"{number}/lab_1_2.ipynb": work(klass) for number in range(9)})
    report = collect(klass.path, [write_zip(tmp_path / "c.zip", {"guest_999_9001_x.zip": archive})])
    assert [one.label for one in report.outcomes] == ["c.zip/guest_999_9001_x.zip"]
    assert "no student in the class is called guest" in why(report)


def test_who_is_excused_from_no_assignment_is_said(klass: TinyClass, tmp_path: Path) -> None:
    (klass.path / "students.csv").write_text("id,excused\nada,lab_1_22\n")
    report = collect(klass.path, [write_zip(tmp_path / "c.zip", {"ada/lab_1_2.ipynb": work(klass)})])
    assert any("students.csv excuses ada from lab_1_22" in note for note in report.notes)


def test_once_the_number_is_known_the_students_own_work_replaces_what_came_under_her_name(
    klass: TinyClass, tmp_path: Path
) -> None:
    """Somebody called herself Ada and came first; her file has the higher number, and so is the later one in Canvas."""
    roster = ROSTER.splitlines(keepends=True)
    without = "".join(line.replace(",101,", ",,") for line in roster)
    (klass.path / "students.csv").write_text(without, encoding="utf-8")
    assert without != ROSTER
    forged, own = (f"lovelaceada_{number}_lab_1_2.ipynb" for number in ("777_9999", "101_5001"))
    works = {forged: work(klass, 1), own: work(klass, 2)}
    collect(klass.path, [write_zip(tmp_path / "first.zip", {forged: works[forged]})])
    assert (klass.path / "submitted/ada/lab_1_2/lab_1_2.ipynb").read_text() == works[forged]
    (klass.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    collect(klass.path, [write_zip(tmp_path / "all.zip", works)])
    assert (klass.path / "submitted/ada/lab_1_2/lab_1_2.ipynb").read_text() == works[own]
