"""A file whose student is not certain waits, and its line shows what decides: both ids, or a pattern for such names."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, read_path, write_zip
from test_collect import placed, why, work
from test_collected_csv import edit

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.systems import NAME_FORMS

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass


@pytest.mark.parametrize(
    ("listed", "name"),
    [
        ("0012345", "12345-Lovelace_lab_1_2.ipynb"),
        ("12345", "0012345-Lovelace_lab_1_2.ipynb"),
        ("0012345", "12354-Lovelace_lab_1_2.ipynb"),
        ("0012345", "12345-Byron_lab_1_2.ipynb"),
    ],
)
def test_an_id_without_its_zeros_shows_the_two_ids_and_takes_one_cell(
    tiny: TinyClass, tmp_path: Path, listed: str, name: str
) -> None:
    (tiny.path / "students.csv").write_text(f"id,first_name,last_name\n{listed},Ada,Lovelace\nben,Ben,Bär\n")
    archive = write_zip(tmp_path / "c.zip", {name: work(tiny, 3)})
    report = collect(tiny.path, [archive], names="{id}-{last}_{assignment}")
    says = name.partition("_")[0].replace("-", " ")
    assert f"no student in the class is called {says}: write the id under student" in why(report)
    edit(tiny, "Lovelace" if "Lovelace" in name else "Byron", student=listed)
    assert placed(collect(tiny.path)).keys() == {listed}


def test_who_is_in_no_list_is_called_by_all_that_the_name_says(klass: TinyClass, tmp_path: Path) -> None:
    archive = write_zip(tmp_path / "c.zip", {"777-Mallory_lab_1_2.ipynb": work(klass)})
    report = collect(klass.path, [archive], names="{id}-{last}_{assignment}")
    assert "no student in the class is called 777 Mallory: write the id under student" in why(report)


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("Lovelace, Ada - lab_1_2.ipynb", "{last}, {first} - lab_1_2"),
        ("homework of ada.love@uni.example.ipynb", "homework of {email}"),
        ("lab-1-2-adalove/lab_1_2.ipynb", "lab-1-2-{github}"),
        ("homework.ipynb", ""),
    ],
)
def test_what_fits_no_system_waits_and_says_what_to_type(
    klass: TinyClass, tmp_path: Path, name: str, pattern: str
) -> None:
    archive = write_zip(tmp_path / "c.zip", {name: work(klass)})
    report = collect(klass.path, [archive])
    assert "the file's name does not identify a student: write the id under student" in why(report)
    assert "collect the file alone with --student ID" in why(report)
    again = collect(klass.path, [archive], names=pattern, student="" if pattern else "ada")
    assert placed(again).keys() == {"ada"}


@pytest.mark.parametrize("system", NAME_FORMS)
def test_the_samples_of_each_row_are_read_by_this_row_and_by_no_other(system: str) -> None:
    assert NAME_FORMS[system].samples
    for sample in NAME_FORMS[system].samples:
        readers = [one.system for one in NAME_FORMS.values() if read_path(sample.split("/"), one.system)]
        assert [one for one in readers if one == system or not NAME_FORMS[one].needs_from] == [system]


def test_a_row_with_ids_of_github_needs_no_system(klass: TinyClass, tmp_path: Path) -> None:
    assert "adalove" in ROSTER
    report = collect(klass.path, [write_zip(tmp_path / "c.zip", {"adalove/lab_1_2.ipynb": work(klass)})])
    assert placed(report).keys() == {"ada"}
