"""Systems that are a row of a table, or a pattern: Sakai, ILIAS, Moodle's naming plugin, worksheets in other languages.

Sakai: scripts in public repositories look for ``Last, First(login)/Submission attachment(s)/`` and read ``grades.csv``.
Moodle's worksheets: the column names are those of Moodle's language packs. ILIAS's folders are from memory.
"""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import pytest
from downloads import ROSTER, write_zip
from test_collect import placed, stamp, why, work
from test_collected_csv import edit

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.written_times import read_time
from autograder.grading.grading_errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.collecting.collect import CollectReport


def gathered(
    klass: TinyClass, folder: Path, files: Mapping[str, str], *, form: str = "", names: str = ""
) -> CollectReport:
    return collect(klass.path, [write_zip(folder / "download.zip", files)], form=form, names=names)


def of(klass: TinyClass, *names: str) -> dict[str, str]:
    """Notebooks of these names, each with other points."""
    return {name: work(klass, points) for points, name in enumerate(names)}


def test_sakai_names_the_user_in_brackets(klass: TinyClass, tmp_path: Path) -> None:
    within = "Submission attachment(s)/lab_1_2.ipynb"
    files = of(klass, f"Lab 1.2/Lovelace, Ada(ada)/{within}", f"Lab 1.2/Bär, Ben(ben@uni.example)/{within}")
    files |= {f"Lab 1.2/Lovelace, Ada(ada)/{name}": "x" for name in ("comments.txt", "timestamp.txt")}
    report = gathered(klass, tmp_path, {**files, "Lab 1.2/grades.csv": '"Lab 1.2","Points"\n'})
    assert placed(report).keys() == {"ada", "ben"}
    assert report.exit_code == 0, why(report)


def test_ilias_is_read_if_the_instructor_says_so(klass: TinyClass, tmp_path: Path) -> None:
    files = of(
        klass, "Lab 1.2/Lovelace_Ada_ada_12345/lab_1_2.ipynb", "Lab 1.2/Zuse_Zoë_zoe_12346/lab_1_2.ipynb"
    )
    assert placed(gathered(klass, tmp_path, files)) == {}
    assert placed(gathered(klass, tmp_path, files, form="ilias")).keys() == {"ada", "zoe"}


@pytest.mark.parametrize(
    ("file", "form", "names"),
    [
        ("Lab 1.2/Bär, Ben(zoe)/Submission attachment(s)/lab_1_2.ipynb", "", ""),
        ("Lab 1.2/Bär_Ben_zoe_12346/lab_1_2.ipynb", "ilias", ""),
        ("Bär-Ben-zoe/lab_1_2.ipynb", "", "{last}-{first}-{login}"),
    ],
)
def test_a_user_name_that_is_another_ones_id_waits(
    klass: TinyClass, tmp_path: Path, file: str, form: str, names: str
) -> None:
    """The system's user names and the ids of the class may be two things."""
    report = gathered(klass, tmp_path, of(klass, file), form=form, names=names)
    assert placed(report) == {}
    assert "may be zoe, ben" in why(report)
    edit(klass, "Ben", student="ben")
    assert placed(collect(klass.path)).keys() == {"ben"}


def test_a_pattern_may_name_a_column_of_the_list_of_students(klass: TinyClass, tmp_path: Path) -> None:
    """Moodle's plugin for names writes what a university has set."""
    lines = ROSTER.splitlines()
    numbers = ["matrikel", "01234567", "01234568", "", "", ""]
    text = "\n".join(f"{line},{number}" for line, number in zip(lines, numbers, strict=True))
    (klass.path / "students.csv").write_text(text, encoding="utf-8")
    files = of(klass, "01234567-Lovelace_lab_1_2.ipynb", "01234568-Baer_Lab 1.2-1.ipynb")
    report = gathered(klass, tmp_path, files, names="{matrikel}-{last}_{assignment}")
    assert placed(report).keys() == {"ada", "ben"}
    with pytest.raises(GradingError, match=r"\{matrikel\}"):
        gathered(klass, tmp_path, files, names="{martikel}-{last}")


@pytest.mark.parametrize(
    ("top", "names"),
    [("", "lab-1-2-{github}"), ("clone/", "{any}/lab-1-2-{github}"), ("clone/", "lab-1-2-{github}")],
)
def test_a_pattern_fits_no_name_that_a_student_chose(
    klass: TinyClass, tmp_path: Path, top: str, names: str
) -> None:
    """Mallory's repository for another lab has a folder that is called as Ada's repository for this one."""
    forged = f"{top}lab-1-3-mallory/lab-1-2-adalove/lab_1_2.ipynb"
    files = of(klass, f"{top}lab-1-2-zz-top/lab_1_2.ipynb", forged)
    report = gathered(klass, tmp_path, files, names=names)
    assert placed(report).keys() == {"zoe"}
    assert "the file's name does not identify a student" in why(report)


def test_of_a_time_in_a_pattern_the_day_alone_is_not_meant(klass: TinyClass, tmp_path: Path) -> None:
    """Both halves of the text before lab_1_2 can be read as a time; a time at midnight would make work late."""
    name = "lovelace_ada_b0012/2025-10-03_140506_lab_1_2.ipynb"
    gathered(klass, tmp_path, of(klass, name), names="{last}_{first}_{any}/{time}_{assignment}")
    assert stamp(klass, "ada") == "2025-10-03 14:05:06.000000 UTC"


@pytest.mark.parametrize("assignment", ["..", ".", "Lab 1.2", "lab_9"])
def test_what_a_name_says_of_no_assignment_of_the_class_leads_nowhere(
    klass: TinyClass, tmp_path: Path, assignment: str
) -> None:
    (klass.path / "stray.ipynb").write_text("{}")
    nameless = work(klass).replace('"grade_id"', '"nobody"')
    report = gathered(klass, tmp_path, {f"ada-{assignment}/x.ipynb": nameless}, names="{id}-{assignment}")
    assert "it is not clear which assignment the file is for" in why(report)
    edit(klass, "x.ipynb", assignment=assignment)
    assert placed(collect(klass.path)) == {}
    assert not [*(klass.path / "submitted").rglob("*.ipynb")]


def test_blind_marking_waits_for_the_worksheet(klass: TinyClass, tmp_path: Path) -> None:
    files = of(klass, "Participant_31_assignsubmission_file_/lab_1_2.ipynb")
    report = gathered(klass, tmp_path, files)
    assert "collect the file together with the grading worksheet" in why(report)
    worksheet = tmp_path / "Grades.csv"
    worksheet.write_text(
        "Identifier,Full name,Email address,Grade\nParticipant 31,Ada,ada.love@uni.example,\n"
    )
    assert placed(collect(klass.path, [worksheet])).keys() == {"ada"}, "the notebook is in the inbox"


WORKSHEETS = {
    "de": (
        'ID;"Vollständiger Name";E-Mail-Adresse;Matrikelnummer;Bewertung;"Zuletzt geändert (Abgabe)"\n'
        'Teilnehmer/in31;"X Y";ada.love@uni.example;;;"Montag, 5. Oktober 2026, 23:30"\n'
    ),
    "fr": (
        "Identifiant,Nom complet,Adresse de courriel,Note,Dernière modification (travail remis)\n"
        'Participant31,X Y,ada.love@uni.example,,"lundi 5 octobre 2026, 23:30"\n'
    ),
}


@pytest.mark.parametrize("language", WORKSHEETS)
def test_a_worksheet_in_another_language_says_who_and_when(
    klass: TinyClass, tmp_path: Path, language: str
) -> None:
    worksheet = tmp_path / "Bewertungen.csv"
    worksheet.write_text(f"\ufeff{WORKSHEETS[language]}", encoding="utf-8")
    files = of(klass, "Unknown_31_assignsubmission_file_/lab_1_2.ipynb")
    report = collect(klass.path, [write_zip(tmp_path / "m.zip", files), worksheet], zone=ZoneInfo("UTC"))
    assert placed(report).keys() == {"ada"}
    assert stamp(klass, "ada")[:16] == "2026-10-05 23:30"


@pytest.mark.parametrize(
    "text",
    [
        "Friday, 3 October 2025, 2:05 PM",
        "Oct 3, 2025 205 PM",
        "3 October, 2025 1405",
        "Freitag, 3. Oktober 2025, 14:05",
        "vendredi 3 octobre 2025, 14:05",
        "3 de octubre de 2025 14h05",
        "viernes, 3 de octubre de 2025, 14:05",
        "3 okt. 2025 14:05",
        "2025-10-03T14:05",
        "2025-10-03-14-05-00",
    ],
)
def test_a_time_in_words_is_read_in_many_languages(text: str) -> None:
    assert read_time(text) == datetime(2025, 10, 3, 14, 5)


@pytest.mark.parametrize(
    "text",
    ["", "soon", "3 4 2025 14:05", "3 October 25 14:05", "October 2025", "32 May 2025 14:05", "3 May 2025 5"],
)
def test_half_a_time_is_none(text: str) -> None:
    assert read_time(text) is None
