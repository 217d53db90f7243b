"""Pictures of a question that a person grades: a solution's is not handed out, a student's is shown to the person."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

import nbformat
import pytest
from nbconvert.exporters import HTMLExporter
from nbformat.v4 import new_code_cell, new_markdown_cell
from nbgrader.converters import GenerateAssignment
from own_assignment import EngineWithAsserts, marked, write_assignment
from test_nbgrader_and_ours import converted

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.running import execution_backends

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

POINT = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg=="
)
"""A PNG of one point; a browser does not mind what is behind its end."""
GIVEN, SCHEME, SHOT = (
    base64.b64encode(POINT + name.encode()).decode() for name in ("given", "scheme", "shot")
)
DRAWN = base64.b64encode(b"<svg>").decode()
QUESTION = """\
Why is a topic many-to-many? ![graph](attachment:graph.png)

### BEGIN SOLUTION
Three points for what is in ![scheme](attachment:scheme.png)
### END SOLUTION
"""
PICTURES = {"graph.png": {"image/png": GIVEN}, "scheme.png": {"image/png": SCHEME}}
ANSWER = "Look:\n\n![shot](attachment:shot.png)\n\n![drawn](attachment:drawn.svg)"


@pytest.fixture
def quiz(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> TinyClass:
    """A class with an assignment whose question has a picture for all, and its solution one for those who grade."""
    monkeypatch.setattr(execution_backends, "execute_all", EngineWithAsserts().execute_all)
    why = marked(new_markdown_cell(QUESTION, attachments=PICTURES), "why", 5)
    why.metadata.nbgrader.update(solution=True, locked=False)
    cells = [marked(new_code_cell("assert True"), "test", 1), why]
    write_assignment(tiny, "quiz", cells)
    return tiny


def hand_in(quiz: TinyClass, student: str, shot: str) -> Path:
    notebook = nbformat.read(quiz.path / "release" / "quiz" / "quiz.ipynb", as_version=4)
    why = notebook.cells[-1]
    why.source = why.source.replace("YOUR ANSWER HERE", ANSWER)
    why.attachments["shot.png"] = {"image/png": shot}
    why.attachments["drawn.svg"] = {"image/svg+xml": DRAWN}
    path = quiz.path / "submitted" / student / "quiz" / "quiz.ipynb"
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, path)
    return path


def pages(quiz: TinyClass, student: str) -> list[str]:
    """The student's page, and the one that formgrader makes with the class's configuration."""
    graded = quiz.path / "autograded" / student / "quiz" / "quiz.ipynb"
    formgrader = HTMLExporter(config=ClassDirectory(quiz.path).config)
    page, _ = formgrader.from_notebook_node(nbformat.read(graded, as_version=4))
    return [(quiz.path / "feedback" / student / "quiz" / "quiz.html").read_text(), page]


@pytest.mark.parametrize("by", ["new-class", "nbgrader generate_assignment"])
def test_the_picture_of_a_solution_is_not_handed_out(quiz: TinyClass, by: str) -> None:
    if by != "new-class":
        converted(quiz, GenerateAssignment, force=True, assignment_id="quiz")
    text = (quiz.path / "release" / "quiz" / "quiz.ipynb").read_text()
    assert GIVEN in text
    assert SCHEME not in text
    assert "scheme.png" not in text


def test_whoever_grades_sees_the_screenshot_and_what_earns_points(quiz: TinyClass) -> None:
    hand_in(quiz, "ada", SHOT)
    quiz.grade(feedback=True)
    for page in pages(quiz, "ada"):
        assert page.count(f'src="data:image/png;base64,{SHOT}"') == 1
        assert page.count(GIVEN) == 1
        assert page.count(SCHEME) == 1
        assert "drawn](attachment:drawn.svg)" in page  # as it was typed: only PNG and JPEG are shown
        assert DRAWN not in page


def test_another_picture_with_the_same_words_is_other_work(quiz: TinyClass) -> None:
    hand_in(quiz, "ada", SHOT)
    quiz.grade(feedback=True)
    other = base64.b64encode(POINT + b"a clearer one").decode()
    hand_in(quiz, "ada", other)
    quiz.grade(feedback=True)
    assert [(other in page, SHOT in page) for page in pages(quiz, "ada")] == [(True, False)] * 2
