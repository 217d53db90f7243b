"""A master that cannot be used is refused with the file, the line and what to do.

Each file in ``bad/`` is a small master with one mistake in it; ``good.md`` has none.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import autograder.masters
from autograder import exercises
from autograder.masters.check_cells import CheckCall, exercise_points
from autograder.masters.master_files import FAULTS, MasterError, masters
from autograder.masters.source_notebooks import Points, source_notebook

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = Path(__file__).parent
# File: line, words of the problem, words of the remedy.
REFUSED = {
    "duplicate_grade_id": (19, "'double' is already used by the cell on line 9", "grade_id"),
    "an_exercise_checked_twice": (24, "'lab_9_1-double' is already used", "one cell only"),
    "no_markers": (12, "without '### BEGIN SOLUTION'", "Put what students"),
    "never_ended": (12, "without '### END SOLUTION'", "Put what students"),
    "misspelt_marker": (13, "marker is misspelt", "'### BEGIN SOLUTION' and nothing else"),
    "markers_swapped": (13, "stands before", "Swap"),
    "no_stub": (14, "does not begin with a TODO comment", "# TODO: "),
    "two_todos": (13, "second TODO", "split it"),
    "two_regions": (17, "A second '### BEGIN SOLUTION'", "split it"),
    "nothing_in_the_region": (14, "holds no solution", "Write it"),
    "the_stub_does_not_run": (9, "Without its solution the cell is not valid Python", "docstring"),
    "the_solution_is_no_python": (16, "The solution is not valid Python", "Correct this line"),
    "region_in_a_given_cell": (9, "in a cell that is not a solution cell", ":tags: [solution]"),
    "solution_without_a_name": (9, "but this one defines", ":grade_id:"),
    "grade_id_with_a_space": (9, "'no good' cannot be a grade_id", "letters"),
    "check_with_another_grade_id": (19, "'other' does not match", "gets 'lab_9_1-double' automatically"),
    "check_of_another_notebook": (19, "does not belong to this notebook", "begin with 'lab_9_1.'"),
    "check_of_what_is_not_written": (
        19,
        "judges 'triple', which no solution cell above it defines",
        "double",
    ),
    "check_of_a_path_that_nobody_writes": (19, "judges 'ros2_ws' on the disk", "%%writefile <path>"),
    "check_of_a_name_in_a_file": (20, "judges 'double', which no solution cell", "nothing so far"),
    "the_file_is_no_python": (17, "The solution is not valid Python", "Correct this line"),
    "check_with_more_in_it": (19, "cannot be read", 'check("lab_9_1.battery", BatteryNode)'),
    "unknown_tag": (9, "Unknown tag 'solutoin'", "solution"),
    "two_tags": (9, "2 tags", "keep one"),
    "unknown_option": (9, "Unknown cell option 'points'", "grade_id, tags"),
    "manual_without_points": (11, "a question that a person grades", '"points": 5'),
    "manual_without_an_answer": (11, "without '### BEGIN SOLUTION'", "Put what students"),
    "manual_without_a_question": (12, "The question is missing", "Ask it above"),
    "manual_code": (9, "A person grades text, not code", '"manual"'),
    "empty_cell": (9, "empty code cell", "delete it"),
    "open_hint": (11, "hint that is not closed", "':::'"),
    "hint_without_a_question": (11, "without its question", ":::{hint} What"),
    "options_no_yaml": (None, "Code cell 0 at line 9 could not be read", "YAML options"),
    "header_no_yaml": (None, "Notebook metadata", "YAML options"),
    "header_without_a_kernel_name": (1, "Jupyter refuses the header", "name: python3"),
    "header_that_is_a_list": (1, "Jupyter refuses the header", "name: python3"),
    "raw_cell": (9, "raw cell", "Markdown or code"),
}


@pytest.fixture
def as_lab_9_1(tmp_path: Path) -> Callable[[Path], Path]:
    """Put a file where it is the master lab_9_1."""

    def put(file: Path) -> Path:
        place = tmp_path / "lab_9_1" / "lab.md"
        place.parent.mkdir()
        return Path(shutil.copy(file, place))

    return put


@pytest.mark.parametrize("name", REFUSED)
def test_a_bad_master_is_refused(name: str, as_lab_9_1: Callable[[Path], Path], ten_points: Points) -> None:
    line, problem, remedy = REFUSED[name]
    path = as_lab_9_1(HERE / "bad" / f"{name}.md")
    with pytest.raises(MasterError) as caught:
        source_notebook(path, points=ten_points)
    assert problem in caught.value.problem
    assert remedy in caught.value.remedy
    assert caught.value.line == line
    assert str(caught.value).startswith(f"{path}:{line}: " if line else f"{path}: ")


def test_every_bad_master_is_expected() -> None:
    assert {path.stem for path in (HERE / "bad").glob("*.md")} == set(REFUSED)


def test_a_good_master_passes_the_same_door(as_lab_9_1: Callable[[Path], Path], ten_points: Points) -> None:
    assert source_notebook(as_lab_9_1(HERE / "good.md"), points=ten_points)


def test_an_unknown_exercise_names_the_nearest(as_lab_9_1: Callable[[Path], Path]) -> None:
    with pytest.raises(MasterError, match=r"exercise 'lab_9_1\.double' does not exist.*lab_1_\d\.") as caught:
        source_notebook(as_lab_9_1(HERE / "good.md"))
    assert caught.value.line == 20


def test_an_exercise_without_points_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    worthless = type("Worthless", (), {"points": 0.0})
    monkeypatch.setattr(exercises, "get", lambda _: worthless)
    with pytest.raises(MasterError, match=r"lab_1_2.lab\.md:7: .*has no points"):
        exercise_points(CheckCall(Path("lab_1_2/lab.md"), 7, "lab_1_2.talker", "TalkerNode"))


def test_bytes_that_are_no_text(tmp_path: Path, ten_points: Points) -> None:
    path = tmp_path / "lab.md"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MasterError, match="not UTF-8"):
        source_notebook(path, points=ten_points)


def test_a_missing_master(tmp_path: Path, ten_points: Points) -> None:
    with pytest.raises(MasterError, match="master does not exist"):
        source_notebook(tmp_path / "lab.md", points=ten_points)


def test_a_folder_without_masters(tmp_path: Path) -> None:
    with pytest.raises(MasterError, match="no folder 'solutions'"):
        masters(tmp_path)
    (tmp_path / "solutions").mkdir()
    with pytest.raises(MasterError, match="No master was found"):
        masters(tmp_path)


def test_each_fault_is_raised_and_each_that_is_raised_has_its_texts() -> None:
    sources = "".join(file.read_text() for file in Path(autograder.masters.__path__[0]).glob("*.py"))
    raised = re.findall(r'(?:Master|Cell)Error\([^"]*?"(\w+)"', sources)
    assert set(raised) == set(FAULTS)
    assert {tuple(texts) for texts in FAULTS.values()} == {("problem", "remedy")}
