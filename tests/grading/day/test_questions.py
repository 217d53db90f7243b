"""A question in a master that a person grades: asked, handed in, shown with what earns points, graded, returned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from bs4 import BeautifulSoup
from instructor import by_person
from test_true_table import page, total
from tiny_class import MASTER, FakeEngine, TinyClass, write_master

from autograder.grading.new_classes.new_class import new_class
from autograder.grading.returning.page_exporter import without_dead_links
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path


QUESTION = cases(__file__, "QUESTION")


@pytest.fixture
def asked(tmp_path: Path, fake_engine: FakeEngine) -> TinyClass:
    write_master(tmp_path / "course", "lab_1_2", MASTER + QUESTION)
    new_class(tmp_path / "class", tmp_path / "course")
    return TinyClass(tmp_path / "class")


def answer(tiny: TinyClass, student: str, text: str) -> None:
    notebook: Any = tiny.released()
    cell = notebook.cells[-1]
    cell.source = cell.source.replace("YOUR ANSWER HERE", text)
    tiny.hand_in(student, notebook)


def row(tiny: TinyClass, student: str) -> tuple[str, float, str]:
    found = next(r for r in tiny.table() if (r["student"], r["exercise"]) == (student, "why_a_topic"))
    return found["state"], float(found["score"]), found["waits_for_a_person"]


def test_students_get_the_question_and_not_its_answer(asked: TinyClass) -> None:
    released = asked.released()
    assert "**Why is this a topic" in released.cells[-1].source
    assert released.cells[-1].source.endswith("YOUR ANSWER HERE")
    assert "nobody waits" not in nbformat.writes(released)


def test_a_person_sees_what_earns_points_and_gives_them(asked: TinyClass) -> None:
    answer(asked, "ada", "Many <script>listen</script>.")
    asked.submit("ben")
    asked.grade(feedback=True)
    assert row(asked, "ada") == ("waits", 0, "yes")
    assert row(asked, "ben") == ("failed", 0, "")  # no answer, so nobody has to look
    graded = nbformat.read(asked.path / "autograded" / "ada" / "lab_1_2" / "lab_1_2.ipynb", as_version=4)
    question, rubric = graded.cells[-2:]
    assert "Many" in question.source
    assert "<script>" not in question.source
    assert "Three points for the first" in rubric.source
    assert "waits for your instructor" in page(asked, "ada")
    by_person(asked, "ada", "why_a_topic", 3)
    asked.grade(feedback=True)
    assert (row(asked, "ada"), total(asked, "ada")) == (("by_hand", 3, ""), 3)
    assert "Three points for the first" in page(asked, "ada")
    assert "Score: 3.0 / 5.0" in page(asked, "ada")
    assert "waits for your instructor" not in page(asked, "ada")
    head = BeautifulSoup(page(asked, "ada"), "html.parser").find(id="toc")
    lines = [[cell.get_text() for cell in line.find_all("td")] for line in head.find_all("tr")]  # type: ignore[union-attr]
    assert [points for _, points, _ in lines] == ["0 of 10", "0 of 10", "3 of 5"]
    assert lines[2][0] == "why a topic"


def test_a_question_that_somebody_has_answered_is_not_built_over(asked: TinyClass) -> None:
    from autograder.masters.chapter_building import holds_work

    released = asked.path / "release" / "lab_1_2" / "lab_1_2.ipynb"
    assert not holds_work(released)
    answer(asked, "ada", "Many listen.")
    assert holds_work(asked.path / "submitted" / "ada" / "lab_1_2" / "lab_1_2.ipynb")


@pytest.mark.parametrize(("link", "stays"), cases(__file__, "a_link_to_a_file_beside_the_page_becomes_text"))
def test_a_link_to_a_file_beside_the_page_becomes_text(link: str, stays: bool) -> None:
    shown = without_dead_links(f"<p>See {link}.</p>")
    assert (link in shown) is stays
    assert BeautifulSoup(shown, "html.parser").get_text() == BeautifulSoup(
        link, "html.parser"
    ).get_text().join(["See ", "."])
