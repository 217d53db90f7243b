"""A second chapter, by somebody else, is a folder: a lab, an interface of its own, an exercise of a new kind.

No line of the engine names the chapter, its lab or its interface. Nor does it lie where the engine does.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
import pytest

from autograder import course
from autograder.authoring.new_exercise import new_exercise
from autograder.boxes.sandbox import why_impossible
from autograder.student.handout import hand_out, readme
from course_runtime.interface_packages import interface_packages
from tests.copies import copied

if TYPE_CHECKING:
    from collections.abc import Callable

CHAPTER = Path(__file__).parent / "second_chapter/solutions/02_power"
EXERCISE, FIRST = "lab_2_1.dimmer", "lab_1_9.battery"

Run = subprocess.CompletedProcess[str]
pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A course with a first chapter, into which the second one's folder was copied."""
    root = tmp_path_factory.mktemp("course")
    (root / "solutions").mkdir()
    new_exercise(root, FIRST, "publisher", chapter="01_first")
    copied(CHAPTER, root / "solutions" / CHAPTER.name)
    return root


@pytest.fixture(scope="module")
def autograder(root: Path) -> Callable[..., Run]:
    """Runs a command of the autograder in that course, which has its two reference outputs and its notebooks.

    Nobody has built the interface: the first command does it.
    """
    environ = os.environ | {"AUTOGRADER_COURSE": str(root)}

    def run(*words: str | Path) -> Run:
        command = [sys.executable, "-m", "autograder", *map(str, words)]
        return subprocess.run(command, env=environ, capture_output=True, text=True, check=False)

    for words in (["record"], ["build"]):
        done = run(*words)
        assert done.returncode == 0, done.stdout + done.stderr
    assert (root / "chapters/02_power/lab_2_1.ipynb").is_file()
    return run


def test_its_solution_is_recorded_and_its_answers_are_judged(autograder: Callable[..., Run]) -> None:
    tried = autograder("try-exercise", EXERCISE)
    assert tried.returncode == 0, tried.stdout + tried.stderr
    assert f"{EXERCISE}: unchanged" in tried.stdout
    assert "2 answers, none not as expected" in tried.stdout


def test_a_command_is_checked(autograder: Callable[..., Run]) -> None:
    answer = CHAPTER / "lab_2_1/dimmer.answers/right/usual.py"
    checked = autograder("check", EXERCISE, "--json", "--", sys.executable, answer)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert json.loads(checked.stdout)["score"] == 10


def test_its_notebooks_are_executed(autograder: Callable[..., Run]) -> None:
    executed = autograder("execute")
    assert executed.returncode == 0, executed.stdout + executed.stderr
    assert "4 notebooks executed, 0 failed" in executed.stdout + executed.stderr


def test_a_class_is_graded_in_boxes(autograder: Callable[..., Run], root: Path, tmp_path: Path) -> None:
    why = why_impossible()
    if why and os.environ.get("CI"):
        pytest.fail(f"no sandbox is possible here, and this project's CI has one: {why}")
    if why:
        pytest.skip(f"no sandbox is possible here: {why}")
    folder = tmp_path / "class"
    made = autograder("new-class", folder, "--assignment", "lab_2_1")
    assert made.returncode == 0, made.stdout + made.stderr
    released = nbformat.read(folder / "release/lab_2_1/lab_2_1.ipynb", as_version=4)
    submit(folder, "unsolved", released)
    solution = (
        (root / "solutions/02_power/lab_2_1/lab.md").read_text().split("[solution]\n")[1].split("```")[0]
    )
    cell = next(cell for cell in released.cells if cell.metadata.get("nbgrader", {}).get("solution"))
    # Whoever asks in a box finds neither the course nor the labs.
    cell.source = solution + "import os, sys\nassert 'AUTOGRADER_COURSE' not in os.environ\n"
    cell.source += f"assert not os.path.exists({str(root / 'solutions')!r})\n"
    cell.source += "assert not [name for name in sys.modules if name.startswith('lab_')]\n"
    submit(folder, "solved", released)
    graded = autograder("grade", folder, "--json")
    assert graded.returncode == 0, graded.stdout + graded.stderr
    assert points(json.loads(graded.stdout)) == {"solved": 10.0, "unsolved": 0.0}


def submit(folder: Path, student: str, notebook: Any) -> None:
    place = folder / "submitted" / student / "lab_2_1"
    place.mkdir(parents=True)
    nbformat.write(notebook, place / "lab_2_1.ipynb")


def points(report: Any) -> dict[str, float]:
    return {one["student"]: one["score"] for one in report["submissions"]}


def test_what_students_are_handed_has_its_interface(root: Path, tmp_path: Path) -> None:
    hand_out(tmp_path / "handed", root)
    given = tmp_path / "handed/exercises/02_power"
    assert (given / "lab_2_1/dimmer.py").is_file()
    assert not (given / "lab_2_1/lab.md").exists()
    assert interface_packages(tmp_path / "handed") == (given / "interfaces/power_interfaces",)
    assert (given / "interfaces/power_interfaces/srv/SetLevel.srv").is_file()
    assert "[ros,notebooks,interfaces]" in readme(course.chapters(root), of_a_clone=False)
