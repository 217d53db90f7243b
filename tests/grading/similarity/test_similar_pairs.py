"""A copy is found however it is dressed up; who has solved a task alike is left in peace; nothing stops the rest."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest
from bs4 import BeautifulSoup
from click.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parent))
from answers_of_students import ALSO_NEAR, COPIED, NEAR, OF_ONES_OWN, SOLUTION, STUB, hand_in, write_task

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError
from autograder.grading.similarity.similar_pairs import SimilarPairs, find_similar
from autograder.grading.similarity.similarity_report import page_html

if TYPE_CHECKING:
    from tiny_class import TinyClass


@pytest.fixture
def class_(tiny: TinyClass) -> TinyClass:
    write_task(tiny)
    return tiny


def found(class_: TinyClass, assignment: str = "") -> SimilarPairs:
    return find_similar(ClassDirectory(class_.path), assignment)


def students(similar: SimilarPairs) -> list[tuple[str, str]]:
    return [(pair.one.answer.student, pair.other.answer.student) for pair in similar.pairs]


def run(class_: TinyClass, *words: str) -> tuple[int, str]:
    result = CliRunner().invoke(cli, ["similar", str(class_.path), *words], env={"COLUMNS": "120"})
    assert not result.exception or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def test_a_copy_with_other_names_texts_and_order_is_found(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "ben", NEAR)
    hand_in(class_, "eve", COPIED)
    similar = found(class_)
    assert students(similar) == [("ada", "eve")]
    (pair,) = similar.pairs
    assert (pair.one.answer.cell, pair.other.answer.cell) == ("Talker", "Talker")
    assert pair.share > 0.8
    assert similar.exit_code == 0


def test_a_copy_in_a_cell_of_ones_own_is_found(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "eve", STUB, "import time", COPIED)
    (pair,) = found(class_).pairs
    assert (pair.one.answer.cell, pair.other.answer.cell) == ("Talker", "own cells")


def test_a_copy_in_an_answer_that_has_become_another_kind_of_cell_is_found(class_: TinyClass) -> None:
    """It is graded as the code cell that it was handed out as."""
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "eve", COPIED)
    path = class_.path / "submitted" / "eve" / "lab_1_2" / "lab_1_2.ipynb"
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        if cell.metadata.get("nbgrader", {}).get("grade_id") == "Talker":
            cell.cell_type = "raw"
            del cell["outputs"], cell["execution_count"]
    nbformat.write(notebook, path)
    assert students(found(class_)) == [("ada", "eve")]


def test_a_copy_of_a_part_is_found(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    more = "\n".join(
        f"    def rule_{n}(self, a):\n        return a ** {n} if a > {n} else -{n}" for n in range(9)
    )
    hand_in(class_, "eve", f"{COPIED}\n{more}\n")
    (pair,) = found(class_).pairs
    assert pair.other.length > 2 * pair.one.length
    assert pair.share > 0.8


def test_a_copied_file_is_found_whatever_its_language(class_: TinyClass) -> None:
    launch = "".join(
        f'  <node pkg="my_robot_pkg" exec="part_{n}" name="n{n}">\n    <param name="rate" value="{n}.5"/>\n  </node>\n'
        for n in range(5)
    )
    hand_in(class_, "ada", f"%%writefile robot.launch.xml\n<launch>\n{launch}</launch>\n")
    hand_in(
        class_, "eve", f"%%writefile my.launch.xml\n<launch>\n\n{launch.replace('  ', '    ')}</launch>\n"
    )
    assert students(found(class_)) == [("ada", "eve")]


@pytest.mark.parametrize("answers", [(NEAR, ALSO_NEAR), (SOLUTION, SOLUTION), (STUB, STUB), (NEAR, NEAR)])
def test_right_answers_near_the_solution_are_no_pair(class_: TinyClass, answers: tuple[str, str]) -> None:
    for student, answer in zip(("ada", "ben"), answers, strict=True):
        hand_in(class_, student, answer)
    assert not found(class_).pairs


def test_what_a_quarter_of_a_class_has_written_is_no_pair(class_: TinyClass) -> None:
    for number in range(4):
        hand_in(class_, f"s{number}", OF_ONES_OWN)
    assert len(found(class_).pairs) == 6, "four who copy from each other are no custom"
    hand_in(class_, "s4", COPIED)
    assert not found(class_).pairs


def test_a_student_is_no_pair_with_oneself(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN, COPIED)
    hand_in(class_, "ben", NEAR)
    assert not found(class_).pairs


def test_the_command_prints_a_table_a_hint_and_the_page(class_: TinyClass, tmp_path: Path) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "eve", COPIED)
    code, output = run(class_)
    assert code == 0
    line = next(line for line in output.splitlines() if "ada, eve" in line)
    assert "lab_1_2, Talker" in line
    assert " % " in line
    assert "hint, not a proof" in output
    assert str(class_.path / "similar.html") in output
    (pair,) = json.loads(run(class_, "--json")[1])["pairs"]
    assert (pair["students"], pair["shared_words"] > 0) == (["ada", "eve"], True)
    code, output = run(class_, "lab_1_2", "--output", str(tmp_path / "there" / "page.html"))
    assert code == 0
    assert (tmp_path / "there" / "page.html").is_file()
    code, output = run(class_, "lab_9_9")
    assert code == 2
    assert "No assignment is named lab_9_9" in output


def test_two_students_are_one_pair_however_many_cells_they_share(class_: TinyClass) -> None:
    """Ben has copied two of Ada's answers, and the first one into a cell of his own, too."""
    second = COPIED.replace("worker", "beeper").replace("* 2", "** 3 // 7")
    hand_in(class_, "ada", OF_ONES_OWN, second)
    hand_in(class_, "ben", OF_ONES_OWN, f"{second}\n{OF_ONES_OWN}")
    hand_in(class_, "eve", NEAR)
    similar = found(class_)
    assert set(students(similar)) == {("ada", "ben")}
    assert len(similar.pairs) > 2
    _, output = run(class_)
    assert output.count("ada, ben") == 1
    shown = BeautifulSoup(page_html(similar), "html.parser")
    assert [heading.get_text() for heading in shown.find_all("h2")] == ["1. ada and ben"]
    assert [link["href"] for link in shown.find_all("a")] == ["#pair-1"]
    assert len(shown.find_all("section")) == 2 * len(similar.pairs)


def test_the_page_shows_both_sides_and_runs_nothing(class_: TinyClass) -> None:
    (class_.path / "students.csv").write_text("id,first_name\nada,<img src=x onerror=alert(1)>\n")
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "eve", COPIED + '# \u202e </code></pre><a href="https://x.example">\x1b[31m\x00 &lt;\n')
    text = page_html(found(class_))
    shown = BeautifulSoup(text, "html.parser")
    assert not shown.find_all(["script", "img", "link", "iframe", "pre", "form"])
    assert [link["href"] for link in shown.find_all("a")] == ["#pair-1"]
    assert not {"\u202e", "\x1b", "\x00"} & set(text)
    assert "<script>alert(1)</script>" in shown.get_text()
    left, right = shown.find_all("section")
    assert "ada" in left.get_text()
    assert "eve" in right.get_text()
    for side, words in ((left, "self.worker.join(timeout=2.0)"), (right, "self.runner.join(timeout=2.0)")):
        marked = "".join(mark.get_text() for mark in side.find_all("mark"))
        assert words in marked
        assert "create_publisher" not in marked, "the task's own"
        assert "the end" not in marked, "only one has it"
    numbers = [{label.get_text() for label in side.select("mark b")} for side in (left, right)]
    assert numbers[0] == numbers[1] >= {"1", "2"}


def test_what_cannot_be_read_has_a_line_and_stops_nothing(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    hand_in(class_, "eve", COPIED)
    class_.hand_in("broken", '{"cells": [')
    class_.hand_in("listed", json.dumps([1, 2]))
    hand_in(class_, "huge", OF_ONES_OWN, "x" * 200_000)
    hand_in(class_, "long", NEAR, "y = [0]\n" * 12_000)
    (class_.path / "submitted" / "empty" / "lab_1_2").mkdir(parents=True)
    (class_.path / "submitted" / "<b>" / "lab_1_2").mkdir(parents=True)
    code, output = run(class_, "lab_1_2")
    assert code == 2
    for words in (
        "unreadable   broken/lab_1_2",
        "unreadable   listed/lab_1_2",
        "unreadable   empty/lab_1_2",
        "left out     huge/lab_1_2: 1 cell(s)",
        "left out     long/lab_1_2: own cells is too long",
        "refused ",
    ):
        assert words in output
    assert {("ada", "eve"), ("ada", "huge"), ("eve", "huge")} == set(students(found(class_)))
    text = (class_.path / "similar.html").read_text()
    assert "broken/lab_1_2" in text
    assert "<b>/" not in text


def test_what_lies_beside_its_place_is_named_and_stays_there(class_: TinyClass) -> None:
    for student in ("ada", "ben", "eve", "zoe"):
        hand_in(class_, student, OF_ONES_OWN)
    submitted = class_.path / "submitted"
    alone = (submitted / "eve" / "lab_1_2" / "lab_1_2.ipynb").rename(
        submitted / "eve" / "lab_1_2" / "lab_1_2 (1).ipynb"
    )
    high = (submitted / "zoe" / "lab_1_2" / "lab_1_2.ipynb").rename(submitted / "zoe" / "lab_1_2.ipynb")
    (submitted / "moodle.zip").write_bytes(b"PK")
    code, output = run(class_)
    assert code == 2
    said = " ".join(output.split())
    for one in (alone, high, submitted / "moodle.zip"):
        assert f"refused {one}: the file is not graded in this place" in said
        assert one.is_file()
    assert students(found(class_)) == [("ada", "ben")]


def test_one_student_is_compared_with_nobody(class_: TinyClass) -> None:
    hand_in(class_, "ada", OF_ONES_OWN)
    code, output = run(class_)
    assert code == 0
    assert "only one student has submitted this notebook" in output
    assert "No two answers" in (class_.path / "similar.html").read_text()


def test_where_nothing_was_handed_in_there_is_nothing_to_compare(class_: TinyClass) -> None:
    code, output = run(class_)
    assert code == 2
    assert "The class has no submissions yet" in output
    assert not (class_.path / "similar.html").exists()
    with pytest.raises(GradingError, match="for lab_1_2"):
        found(class_, "lab_1_2")
