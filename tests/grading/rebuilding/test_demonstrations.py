"""Which cells are left out while a class is graded: those of the course, and what must never be among them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder import course
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.new_classes.new_class import release
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.tasks.task_making import LEFT_OUT, demonstrations_of, is_demonstration
from autograder.masters.source_notebooks import SET_UP_CELL as SET_UP_CELL

if TYPE_CHECKING:
    from nbformat import NotebookNode
    from tiny_class import FakeEngine, TinyClass


def given(source: str, **marks: object) -> NotebookNode:
    cell = nbformat.v4.new_code_cell(source)
    cell.metadata["nbgrader"] = {"locked": True, "grade": False, "solution": False, **marks}
    return cell


def shown(source: str, **marks: object) -> NotebookNode:
    cell = given(source, **marks)
    cell.metadata["tags"] = ["demonstration"]
    return cell


def test_only_the_masters_own_cells_count() -> None:
    script = "%%bash\nros2 topic list"
    assert is_demonstration(shown(script))
    assert not is_demonstration(given(script))
    assert not is_demonstration(shown(script, locked=False))
    assert not is_demonstration(shown(script, solution=True))
    assert not is_demonstration(shown(script, grade=True))
    students = nbformat.v4.new_code_cell(script, metadata={"tags": ["demonstration"]})
    assert not is_demonstration(students)


def test_below_the_last_check_no_file_is_written_and_nothing_is_built() -> None:
    build, write = "%%bash\ncolcon build", "%%writefile a.py\nx = 1"
    check, answer = given("check('a.b', C)", grade=True), given("x = []", solution=True, locked=False)
    own = nbformat.v4.new_code_cell(build)
    above = [given(build), given(write, solution=True, locked=False), check]
    below = [given(build), given(write, solution=True, locked=False), answer, own, given("print(1)")]
    notebook = nbformat.v4.new_notebook(cells=[*above, *below])
    assert demonstrations_of(notebook) == {3, 4}
    # A notebook without a check has nothing below one.
    assert demonstrations_of(nbformat.v4.new_notebook(cells=below)) == set()


def test_of_the_course_no_check_no_answer_and_no_build_is_left_out() -> None:
    left_out = []
    for chapter in (course.root() / course.CHAPTERS).glob("*/*.ipynb"):
        for cell in nbformat.read(chapter, as_version=4).cells:
            if is_demonstration(cell) and cell.metadata.nbgrader.grade_id != SET_UP_CELL:
                left_out.append(cell.source)
    assert len(left_out) > 30
    for source in left_out:
        runs_a_node = any(
            words in source for words in ("robot", "spin_in_background(", "ask_once(", ".stop()")
        )
        is_shown = source.startswith(("%%bash", "# @title Set the course up")) or runs_a_node
        assert is_shown, (
            "a terminal, the robot's scene, a node, or the cell that sets the course up elsewhere"
        )
        assert not any(word in source for word in ("colcon build", "pkg create", "mkdir", "%%writefile"))


@pytest.mark.parametrize("wanted", [False, True])
def test_a_class_says_whether_its_demonstrations_are_run(
    tiny: TinyClass, fake_engine: FakeEngine, wanted: bool
) -> None:
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    notebook = nbformat_nodes.read(source.read_text())
    notebook.cells.insert(1, shown("%%bash\nros2 topic list", grade_id="given-list", schema_version=3))
    source.write_text(nbformat_nodes.text(notebook))
    release(ClassDirectory(tiny.path))
    if wanted:
        tiny.configure("c.WireExecute.demonstrations = True")
    tiny.submit("ada")
    asked: list[str] = []
    fake_engine.before = lambda task: asked.extend(cell.source for cell in task.cells)
    tiny.grade(feedback=True)
    assert ("%%bash\nros2 topic list" in asked) is wanted
    page = (tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").read_text()
    assert (LEFT_OUT in page) is not wanted
    assert "ros2 topic list" in page
