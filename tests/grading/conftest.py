"""A tiny class in a test's own folder, and what stands for the parts that are slow."""

from __future__ import annotations

import functools
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.grading import course_version
from autograder.grading.course_version import CourseFiles
from autograder.grading.rebuilding import submission_desk

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent / "collecting"))
sys.path.insert(0, str(Path(__file__).parent / "day"))
from downloads import ROSTER
from tiny_class import COURSE, FakeEngine, TinyClass, make_tiny_class

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.boxes.reading_desks import Desk, KeptDesk

SMALL = 100_000
"""Bytes of a file that is kept in the memory of the tests, with what it holds."""
_document_of = submission_desk.document_of
_once = functools.lru_cache(maxsize=300)(submission_desk.document_of)


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

    def document(asked: Desk | KeptDesk, data: bytes) -> bytes:
        return (_once if len(data) < SMALL else _document_of)(asked, data)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(submission_desk, "document_of", document)
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
