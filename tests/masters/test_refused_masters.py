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
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = Path(__file__).parent
REFUSED = cases(__file__, "REFUSED")


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
    assert caught.value.line == (line or None)
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
