"""The course's version moves with every file that may decide a grade."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from autograder import course
from autograder.grading.cluster import cluster_dispatcher, dask_worker
from autograder.grading.course_version import (
    GRADER,
    JUDGE,
    SHARED,
    CourseFiles,
    counted_files,
    course_version,
    part_of,
)
from tests.cases import cases
from tests.copies import copied
from tests.reach.imports import imports_of

ROOT = Path(__file__).resolve().parents[2]
# What git keeps of these counts. That list is not taken from the code under test.
PLACES = cases(__file__, "PLACES")


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the course whose files a test may change."""
    for name in ("autograder", "course_runtime", "environment", "solutions"):
        copied(ROOT / name, tmp_path / name)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    monkeypatch.setattr(course, "__file__", str(tmp_path / "autograder" / "course.py"))
    return tmp_path


def version() -> str:
    return CourseFiles(files().items()).version()


def files() -> dict[str, bytes]:
    return {name: path.read_bytes() for name, path in counted_files()}


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
    """Of each twenty-fifth: that all are counted is asked above."""
    seen, some = {version()}, kept()[::25]
    for name in some:
        file = copy / name
        before = file.read_bytes()
        file.write_bytes(before[:-1] + bytes([(before[-1] + 1) % 256]) if before else b" ")
        seen.add(version())
        file.write_bytes(before)
    assert len(seen) == len(some) + 1
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


def test_both_ends_of_a_cluster_go_by_the_same_value() -> None:
    modules = (dask_worker, cluster_dispatcher)
    assert {vars(module)["course_version"] for module in modules} == {course_version}


LABS = ("lab_1_2", "lab_1_4", "lab_1_4_robot", "lab_2_3", "bugs_1", "bugs_2")


@pytest.mark.parametrize(
    ("name", "moved"),
    cases(__file__, "a_file_moves_the_parts_that_depend_on_it"),
)
def test_a_file_moves_the_parts_that_depend_on_it(name: str, moved: tuple[str, ...]) -> None:
    contents = files()

    def parts() -> dict[str, str]:
        made = CourseFiles(contents.items())
        exercises = {lab: made.version(*made.labs(f"check('{lab}.one')".encode()), SHARED) for lab in LABS}
        return {"judge": made.version(JUDGE), "grader": made.version(GRADER), **exercises}

    before = parts()
    contents[name] += b" "
    after = parts()
    assert {part for part, value in after.items() if value != before[part]} == set(moved)


MAY_ENTER_A_RESULT = {
    "autograder.cards",  # cards are shown in the student's kernel; the judge cannot import them
    "autograder.grading.grading_task",
    "autograder.grading.grading_errors",
    "autograder.grading.course_version",
}
"""What the judge's part of the course imports from the grader's part."""


def test_what_executes_and_judges_runs_no_code_of_the_grader() -> None:
    """Otherwise a change of the grader could change a result, and the result would be kept."""
    wrong = [
        f"{name} imports {one.name}"
        for name, path in counted_files()
        if name.endswith(".py") and name.startswith("autograder/") and part_of(name) == JUDGE
        if not name.startswith(("autograder/masters/", "autograder/student/", "autograder/__main__"))
        for one in imports_of(path)
        if part_of(f"{one.name.replace('.', '/')}/") == GRADER and not one.for_types
        if not any(one.name.startswith(allowed) for allowed in MAY_ENTER_A_RESULT)
    ]
    assert not wrong
