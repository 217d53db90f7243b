"""The page about a class says what the gradebook says, to anybody, without a script and without a network."""

from __future__ import annotations

import shutil
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
import tiny_class
from bs4 import BeautifulSoup
from click.testing import CliRunner
from downloads import ROSTER
from instructor import by_person
from test_true_table import nbgraders_total
from tiny_class import FakeEngine, TinyClass

from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting import class_statistics as figures
from autograder.grading.reporting.class_table import ClassTable, read_table
from autograder.grading.reporting.report_page import write_report
from autograder.grading.table.rows import Row
from autograder.grading.tasks.result_keys import ResultKeys
from autograder.grading.tasks.source_points import read_released
from autograder.verdict import CriterionResult, Diagnosis, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

GIVEN = {"ada": (10, 10), "ben": (4, 0), "eve": (2, 1), "jose": ("1/0", 10)}


@pytest.fixture(scope="module")
def _criteria() -> Iterator[None]:
    """Each check has a criterion."""
    plain = tiny_class.verdict

    def with_criteria(exercise: str, score: float, seed: str) -> Verdict:
        criterion = CriterionResult("text", "Says the right thing", 10, score == 10, "", "")
        return replace(plain(exercise, score, seed), criteria=(criterion,))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiny_class, "verdict", with_criteria)
        yield


@pytest.fixture(scope="module")
def _graded(_criteria: None, to_be_copied: TinyClass) -> Path:
    (to_be_copied.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    for student, answers in GIVEN.items():
        to_be_copied.submit(student, *answers)
    with FakeEngine().at_work():
        to_be_copied.grade(feedback=True)
        by_person(to_be_copied, "ben", "lab_1_2-talker", 5, extra=1)
        to_be_copied.grade(feedback=True)
    return to_be_copied.path


@pytest.fixture
def graded(_graded: Path, fake_engine: FakeEngine, tmp_path: Path) -> TinyClass:
    """A class of five, of whom one has handed in nothing, with points by hand."""
    return TinyClass(shutil.copytree(_graded, tmp_path / "graded"))


def test_the_figures_are_the_gradebooks(graded: TinyClass) -> None:
    table = read_table(ClassDirectory(graded.path))
    assert {student: table.score(student) for student in GIVEN} == {
        student: nbgraders_total(graded, student) for student in GIVEN
    }
    assert sorted(figures.totals(table).values()) == [3, 6, 10, 20]
    assert [(band.low, band.students) for band in figures.bands(table) if band.students] == [
        (10, ("eve",)),
        (30, ("ben",)),
        (50, ("jose",)),
        (90, ("ada",)),
    ]
    talker, listener = figures.items(table, ClassStore(ClassDirectory(graded.path)))
    assert (talker.handed_in, talker.mean, talker.full, talker.none) == (4, 4.5, 1, 1)
    assert talker.discrimination == pytest.approx(7.5 / (59 * 90.75) ** 0.5)
    assert (listener.full, listener.none) == (2, 1)
    assert [(one.title, one.passed, one.of) for one in talker.criteria] == [("Says the right thing", 1, 3)]
    assert [(one.passed, one.of) for one in listener.criteria] == [(2, 4)]
    mistakes = {(one.exercise, one.key): one.students for one in figures.mistakes(table)}
    assert mistakes["lab_1_2.talker", "wrong_text"] == ("ben", "eve")
    assert mistakes["lab_1_2.talker", "crashed"] == ("jose",)


def test_work_that_is_not_graded_yet_is_blank_and_in_no_figure(graded: TinyClass) -> None:
    graded.submit("zoe", 10, 10)
    table = read_table(ClassDirectory(graded.path))
    assert sorted(figures.totals(table).values()) == [3, 6, 10, 20]
    assert not any("zoe" in band.students for band in figures.bands(table))
    items = figures.items(table, ClassStore(ClassDirectory(graded.path)))
    assert [item.handed_in for item in items] == [4, 4]
    page = BeautifulSoup(write_report(graded.path).read_text(), "html.parser")
    titled = page.find("h2", string="Points of each student")
    assert titled
    table_of_page = titled.find_next("table")
    assert table_of_page
    zoe = next(line for line in table_of_page.find_all("tr") if "zoe" in line.get_text())
    assert [cell.get_text(strip=True) for cell in zoe.find_all("td")][1:] == ["–", "–", "–"]


def test_titles_and_quotes_take_the_place_of_ids_and_back_ticks(graded: TinyClass) -> None:
    page = BeautifulSoup(write_report(graded.path).read_text(), "html.parser")
    text = page.get_text(" ", strip=True)
    assert "Lab 1.2 · The talker lab_1_2.talker" in text
    assert "`" not in text
    assert "wrong text" in text
    assert "wrong_text" not in text
    told = page.find("th", string="what they were told").find_next("tbody").find_all("tr")  # type: ignore[union-attr]
    assert all(row.find_all("td")[2].get_text(strip=True)[0] == "“" for row in told)


def test_the_page_needs_nothing_and_links_lead_somewhere(graded: TinyClass) -> None:
    path = write_report(graded.path)
    text = path.read_text()
    page = BeautifulSoup(text, "html.parser")
    assert not page.find_all(["script", "link", "img", "iframe"])
    assert "http" not in text.replace("http-equiv", "")
    links = {link["href"] for link in page.find_all("a")}
    assert len(links) == 4
    assert all((graded.path / str(link)).is_file() for link in links)
    assert "Zoë Zuse (zoe)" in text
    assert "Nothing handed in" in text
    assert "6*" in text
    assert page.find(role="img")["aria-label"] == "0 students"  # type: ignore[index]


def test_two_assignments_with_cells_of_one_name_stay_apart(graded: TinyClass) -> None:
    from own_assignment import write_assignment

    for name in ("one", "two"):
        write_assignment(graded, name)
    directory = ClassDirectory(graded.path)
    cells = read_released(directory, ClassStore(directory), ResultKeys(directory)).cells
    assert [cell.exercise for cell in cells["one"]] == [cell.exercise for cell in cells["two"]]
    points = {"one": 2.0, "two": 1.0}
    found = [
        Row("ada", assignment, "small", score, 2, "failed", "assertion_failed", "No.")
        for assignment, score in points.items()
    ]
    table = ClassTable(tuple(found), read_table(ClassDirectory(graded.path)).roster, {})
    items = figures.items(table, ClassStore(ClassDirectory(graded.path)))
    assert [(one.exercise, one.mean, one.handed_in) for one in items] == [
        ("one.small", 2, 1),
        ("two.small", 1, 1),
    ]
    assert [(one.assignment, one.students) for one in figures.mistakes(table)] == [
        ("one", ("ada",)),
        ("two", ("ada",)),
    ]


def test_names_can_be_left_out(graded: TinyClass) -> None:
    text = write_report(graded.path, names=False).read_text()
    for word in ("Ada", "ada", "Lovelace", "ben", "jose", "feedback/"):
        assert word not in text
    assert "student 1" in text


def test_nothing_of_a_name_is_markup(graded: TinyClass) -> None:
    (graded.path / "students.csv").write_text("id,first_name\nada,<script>alert(1)</script>\n")
    assert "<script>" not in write_report(graded.path).read_text()


def test_what_turns_the_direction_of_writing_is_shown_as_an_escape(
    graded: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = Diagnosis("wrong_text", "It says “\u202egro.live\x1b[2J\0”.", "Say the right thing.")
    plain = tiny_class.verdict
    monkeypatch.setattr(tiny_class, "verdict", lambda *words: replace(plain(*words), diagnosis=said))
    graded.submit("ben", 3, 3)
    graded.grade()
    (graded.path / "students.csv").write_text("id,first_name\nada,\u202enimda\u2066\x1b\nben,\n")
    text = write_report(graded.path).read_text()
    assert "\\u202egro.live" in text
    assert "\\u202enimda" in text
    assert not set("\u202e\u2066\x1b\0") & set(text)


def test_the_command_says_where_the_page_is(graded: TinyClass, tmp_path: Path) -> None:
    to = tmp_path / "elsewhere" / "page.html"
    result = CliRunner().invoke(cli, ["report", str(graded.path), "--output", str(to)])
    assert (result.exit_code, result.output.strip()) == (0, str(to))
    assert "file:///" in to.read_text()


def test_without_work_there_is_nothing_to_report(tiny: TinyClass) -> None:
    with pytest.raises(GradingError, match="The class has no submissions yet"):
        write_report(tiny.path)
