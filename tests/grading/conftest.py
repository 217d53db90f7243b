"""A tiny class in a test's own folder, and what stands for the parts that are slow."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder.boxes.reading_desks import KeptDesk
from autograder.grading import course_version
from autograder.grading.course_version import CourseFiles

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent / "collecting"))
sys.path.insert(0, str(Path(__file__).parent / "day"))
from downloads import ROSTER
from tiny_class import COURSE, FakeEngine, TinyClass, make_tiny_class

if TYPE_CHECKING:
    from collections.abc import Iterator

SMALL = 100_000
"""Bytes of a file that is kept in the memory of the tests, with what it holds."""
_once: dict[bytes, Any] = {}
"""What a desk answered about the bytes of a notebook."""


def pytest_itemcollected(item: pytest.Item) -> None:
    """Called for each test below this folder: SQLAlchemy warns of nbgrader's own models."""
    item.add_marker(pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning"))


@pytest.fixture(scope="session")
def _made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_tiny_class(tmp_path_factory.mktemp("classes"))


@pytest.fixture(scope="module")
def to_be_copied(_made: Path, tmp_path_factory: pytest.TempPathFactory) -> TinyClass:
    """A fresh class, which a module grades once; its tests work on copies."""
    return TinyClass(shutil.copytree(_made, tmp_path_factory.mktemp("graded") / "class"))


@pytest.fixture
def tiny(_made: Path, tmp_path: Path) -> TinyClass:
    """A fresh class without submissions."""
    shutil.copytree(_made, tmp_path / "class")
    return TinyClass(tmp_path / "class")


@pytest.fixture
def klass(tiny: TinyClass) -> TinyClass:
    """A tiny class with a roster."""
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    return tiny


@pytest.fixture(scope="module", autouse=True)
def _the_course_stands_still() -> Iterator[None]:
    """Several processes and runs must agree on it, also while somebody edits the course."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(course_version, "course_files", lambda: CourseFiles(COURSE.items()))
        yield


@pytest.fixture(scope="module", autouse=True)
def each_file_is_read_once() -> Iterator[None]:
    """A desk knows nothing but the bytes of a file, so it returns the same for the same bytes."""

    read = KeptDesk.read

    def read_once(self: KeptDesk, request: str, data: bytes, kind: Any, **words: Any) -> Any:
        if request != "submission" or len(data) > SMALL:
            return read(self, request, data, kind, **words)
        if data not in _once:
            _once[data] = read(self, request, data, kind, **words)
        return _once[data]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(KeptDesk, "read", read_once)
        yield


@pytest.fixture
def fake_engine() -> Iterator[FakeEngine]:
    """Nothing is executed in this test."""
    fake = FakeEngine()
    with fake.at_work():
        yield fake


@pytest.fixture
def with_fake_judge(monkeypatch: pytest.MonkeyPatch) -> str:
    """Real workers and kernels, no ROS: hand this to ``grade(judge=...)``."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    return "fake_judge:FakeJudge"
