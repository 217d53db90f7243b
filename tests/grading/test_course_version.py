"""The course's version moves with every file that may decide a grade."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from autograder import course
from autograder.grading.cluster import dask_worker
from autograder.grading.course_version import counted_files, course_version
from autograder.grading.running import task_dispatcher
from autograder.grading.tasks import submission_fingerprints

ROOT = Path(__file__).resolve().parents[2]
# What git keeps of these counts. That list is not taken from the code under test.
PLACES = (
    "autograder",
    "environment",
    ":(glob)solutions/*/*/*.py",
    ":(glob)solutions/*/*/*.reference.json",
    ":(glob)solutions/*/*/*.ticket.toml",
    ":(glob)solutions/*/chapter.toml",
    "solutions/ros2_ws",
)


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the course whose files a test may change."""
    for name in ("autograder", "environment", "solutions"):
        ignored = shutil.ignore_patterns("__pycache__", "build", "install", "log")
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    monkeypatch.setattr(course, "__file__", str(tmp_path / "autograder" / "course.py"))
    return tmp_path


def version() -> str:
    return course_version.__wrapped__()


def kept() -> list[str]:
    done = subprocess.run(
        ["git", "ls-files", "-z", *PLACES], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip("this copy of the course is no clone")
    return [name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_every_file_that_is_kept_counts(copy: Path) -> None:
    counted = {name for name, _ in counted_files()}
    assert not set(kept()) - counted
    assert not [name for name in counted if name.endswith(".pyc")]


def test_a_changed_byte_in_any_of_them_moves_it(copy: Path) -> None:
    seen = {version()}
    for name in kept():
        file = copy / name
        before = file.read_bytes()
        file.write_bytes(before[:-1] + bytes([(before[-1] + 1) % 256]) if before else b" ")
        seen.add(version())
        file.write_bytes(before)
    assert len(seen) == len(kept()) + 1
    assert version() in seen


def test_a_file_that_comes_goes_or_is_renamed_moves_it(copy: Path) -> None:
    seen = [version()]
    new = copy / "autograder" / "workspaces" / "new.py"
    new.touch()
    seen.append(version())
    new.rename(new.with_name("renamed.py"))
    seen.append(version())
    (copy / "autograder" / "verdict.py").unlink()
    seen.append(version())
    # Only beside the folder src of a workspace these are colcon's.
    for name in ("autograder/log/new.py", "solutions/02_power/interfaces/power_interfaces/srv/SetLevel.srv"):
        (copy / name).parent.mkdir(parents=True)
        (copy / name).touch()
        seen.append(version())
    assert len(set(seen)) == len(seen)


def test_what_is_made_from_them_and_the_masters_do_not_count(copy: Path) -> None:
    before = version()
    for name in ("autograder/__pycache__/x.pyc", "solutions/ros2_ws/build/x.o", "autograder/.editor.swp"):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_text("made")
    master = next((copy / "solutions").glob("*/*/lab.md"))
    master.write_text("another")
    assert version() == before


def test_it_does_not_depend_on_where_the_course_lies(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here = version()
    monkeypatch.undo()
    assert version() == here


def test_results_grades_and_clusters_go_by_the_same_value() -> None:
    # What tasks go by stands still in these tests (conftest.py).
    modules = (submission_fingerprints, dask_worker, task_dispatcher)
    assert {vars(module)["course_version"] for module in modules} == {course_version}
