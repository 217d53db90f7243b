"""Students choose their names in a system, and their user names: no such name makes work another's, or nobody's."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip, zipped
from test_chosen_names import folder, when
from test_collect import lies, placed, why, work

from autograder.grading.collecting.collect import collect

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass


@pytest.mark.parametrize(
    "hers", ["_777_5003_", "123_777_5003_", "_LATE_777_5003_", "1_1_1_777_5003_", "mallory_777_5003_\n"]
)
def test_in_canvas_nobody_is_called_so_that_the_name_is_not_the_systems(
    klass: TinyClass, tmp_path: Path, hers: str
) -> None:
    """Of 🙂 Canvas leaves nothing. A table was the instructor's list then, and an archive a download."""
    listed = "user_id,submitted_at,login_id\n102,2031-01-01T12:00:00Z,ben\n"
    files = {"barben_102_5005_lab_1_2.ipynb": work(klass, 1), f"{hers}t.csv": listed}
    folder(tmp_path / "d", files)
    forged = {name: work(klass, 9) for name in ("barben_102_99999_lab_1_2.ipynb", "zoe/lab_1_2.ipynb")}
    write_zip(tmp_path / "d" / f"{hers}x.zip", forged)
    (tmp_path / "d" / f"{hers}x_102_9999_lab_1_2.ipynb").write_text(work(klass, 9))
    report = collect(klass.path, sorted((tmp_path / "d").iterdir()))
    assert (placed(report).keys(), lies(klass, "ben"), when(klass, "ben")) == ({"ben"}, work(klass, 1), None)
    assert report.exit_code == 2


@pytest.mark.parametrize(
    "hers",
    ["mallory_102_104_5003_lab_1_2", "mallory_102_9999_x_104_5003_lab_1_2", "bärben_102_104_5003_lab_1_2"],
)
def test_in_canvas_nobody_has_anothers_number_as_a_part_of_her_name(
    klass: TinyClass, tmp_path: Path, hers: str
) -> None:
    download = write_zip(tmp_path / "c.zip", {f"{hers}.ipynb": work(klass, 9)})
    report = collect(klass.path, [download])
    assert placed(report) == {}
    assert " may be ben, eve: write the id under student" in why(report)
    honest = {"barben_102_5001_101_2.ipynb": work(klass, 1), "oneilleve_104_5002_1_200_3.ipynb": work(klass)}
    assert placed(collect(klass.path, [write_zip(tmp_path / "d.zip", honest)])).keys() == {"ben", "eve"}


def test_in_gradescope_nobody_is_who_the_list_knows_by_an_address(klass: TinyClass, tmp_path: Path) -> None:
    about = "submission_{}:\n  :submitters:\n  - :name: Ben Bär\n    :email: {}\n  :created_at: 2025-04-{} 17:34:00 Z\n"
    files = {f"assignment_1_export/submission_{day}/lab_1_2.ipynb": work(klass, day - 10) for day in (11, 12)}
    addresses = {11: "ben@uni.example", 12: "mallory@mail.example"}
    files["assignment_1_export/submission_metadata.yml"] = "".join(
        about.format(day, address, day) for day, address in addresses.items()
    )
    report = collect(klass.path, [write_zip(tmp_path / "g.zip", files)])
    assert lies(klass, "ben") == work(klass, 1)
    assert "submission_12/lab_1_2.ipynb: no student in the class is called Ben Bär" in why(report)
    folder(tmp_path, files)
    report = collect(klass.path, [tmp_path / "assignment_1_export" / "submission_11"])
    assert why(report) == "", "the list that came with the export says who number 11 is"


def test_in_brightspace_two_people_of_one_name_are_told_apart(klass: TinyClass, tmp_path: Path) -> None:
    name = "{}-2 - Ben Bär - Oct {}, 2025 205 PM - lab_1_2.ipynb"
    files = {name.format(number, number): work(klass, number) for number in (1, 9)}
    report = collect(klass.path, [write_zip(tmp_path / "b.zip", files)])
    assert placed(report) == {}
    assert "several people in the LMS have the name of ben; their numbers are 1, 9" in why(report)
    (klass.path / "students.csv").write_text("id,first_name,last_name,brightspace\nben,Ben,Bär,1\n")
    assert lies(klass, placed(collect(klass.path, [tmp_path / "b.zip"])).popitem()[0]) == work(klass, 1)


@pytest.mark.parametrize("login", ["2-submissions", "adalove-main", "main"])
def test_no_login_on_github_takes_the_work_of_others(klass: TinyClass, tmp_path: Path, login: str) -> None:
    """So ends the folder that gh makes for all, and so a repository of Ada's with its branch."""
    (klass.path / "students.csv").write_text(f"{ROSTER}mal,Mal,Lory,mal@uni.example,106,{login}\n")
    everything = tmp_path / "lab-1-2-submissions"
    folder(everything, {"lab-1-2-adalove/lab_1_2.ipynb": work(klass, 1)})
    names = "lab-1-2-submissions/lab-1-2-{github}"
    assert placed(collect(klass.path, [everything], names=names)).keys() == {"ada"}
    folder(tmp_path / "d", {f"lab-1-2-{login}/lab_1_2.ipynb": work(klass, 9)})
    collect(klass.path, [tmp_path / "d" / f"lab-1-2-{login}"], names="lab-1-2-{github}")
    assert (lies(klass, "ada"), lies(klass, "mal")) == (work(klass, 1), work(klass, 9))


def test_user_names_of_github_are_the_same_with_capitals(klass: TinyClass, tmp_path: Path) -> None:
    folder(tmp_path / "all", {"lab-1-2-AdaLove/lab_1_2.ipynb": work(klass)})
    assert placed(collect(klass.path, [tmp_path / "all"], names="lab-1-2-{github}")).keys() == {"ada"}


def test_a_named_file_whose_name_is_no_text_is_one_line(klass: TinyClass, tmp_path: Path) -> None:
    """As unzip leaves them that knows no accents, with download/*."""
    for name in (
        "Jos\udce9_12_assignsubmission_file_lab_1_2.ipynb",
        "Ben Bär_13_assignsubmission_file_x.ipynb",
    ):
        (tmp_path / name).write_text(work(klass))
    (tmp_path / "Zo\udceb_14_assignsubmission_file_").mkdir()
    (tmp_path / "Zo\udceb_14_assignsubmission_file_" / "lab_1_2.ipynb").write_text(work(klass))
    (tmp_path / "Zo\udceb_15_assignsubmission_file_x.zip").write_bytes(zipped({"lab_1_2.ipynb": work(klass)}))
    (tmp_path / "Zo\udceb.zip").write_bytes(
        zipped({"Ada Lovelace_1_assignsubmission_file_x.ipynb": work(klass)})
    )
    sources = sorted(path for path in tmp_path.iterdir() if "_file_" in path.name)
    report = collect(klass.path, sources)
    assert placed(report).keys() == {"ben"}
    assert os.fsencode(why(report)) == why(report).encode()
    assert "no student in the class is called Jos?" in why(report)
    report = collect(klass.path, [tmp_path / "Zo\udceb.zip"])
    assert placed(report).keys() == {"ada"}
