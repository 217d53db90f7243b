"""A class that the course of 7042be52 made and graded goes on: what was handed in is graded, and no point is lost.

``class_of_7042be52.tar.xz`` is its folder. Both students have handed in ``project_2`` and ``lab_2_0``, made from the
notebooks of that day; only ``project_2`` was graded then. At that time no class had drawings of its own.
"""

from __future__ import annotations

import tarfile
from pathlib import Path

import pytest
from tiny_class import QUIET

from autograder.appeals import appeal_file
from autograder.appeals.replaying import replay
from autograder.grading.batch import grade
from autograder.grading.reporting.appeal_writing import write_appeal

pytestmark = [pytest.mark.ros, pytest.mark.slow]

EARLIER = Path(__file__).with_name("class_of_7042be52.tar.xz")
GRADED, NEW = "project_2.agent", "lab_2_0.bridge"


@pytest.fixture(scope="module")
def earlier(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("earlier")
    with tarfile.open(EARLIER) as packed:
        packed.extractall(folder, filter="data")
    return folder / "class"


@pytest.fixture(scope="module")
def graded(earlier: Path) -> dict[tuple[str, str], float]:
    report = grade(earlier, feedback=False, console=QUIET, jobs=2)
    assert not report.problems
    return {(row.student, row.exercise): row.score for row in report.rows}


def test_it_is_graded_by_the_course_of_today(graded: dict[tuple[str, str], float]) -> None:
    assert graded["honest", GRADED] == 10
    assert graded["honest", NEW] == 10
    assert graded["swapped", GRADED] == 0
    assert graded["swapped", NEW] < 10


@pytest.mark.parametrize("student", ["honest", "swapped"])
@pytest.mark.parametrize("exercise_id", [GRADED, NEW])
@pytest.mark.usefixtures("graded")
def test_each_check_is_judged_again_alike(student: str, exercise_id: str, earlier: Path) -> None:
    again = replay(appeal_file.read(write_appeal(earlier, student, exercise_id)).seen)
    assert again.differences == []
