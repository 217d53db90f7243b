"""The builds of a class: none is shared with another submission or an earlier execution, but for the course's own."""

from __future__ import annotations

import itertools
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import course
from autograder.grading.new_classes.sample_class import _without_markers
from autograder.masters.master_files import masters
from autograder.masters.source_notebooks import source_notebook
from autograder.workspaces import graded_builds
from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.graded_builds import (
    BUILT_AHEAD,
    GradedBuilds,
    build_ahead,
    packages_to_build_ahead,
)

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import interface_package, python_package
from test_grading_service import FakeJobs

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.workspaces.builds.colcon_build import Build


@pytest.fixture
def ahead(tmp_path: Path) -> Path:
    """An empty folder for what is built ahead."""
    folder = tmp_path / "ahead"
    folder.mkdir(mode=0o700)
    return folder


@pytest.fixture
def execution(tmp_path: Path, ahead: Path) -> Callable[[], tuple[GradedBuilds, FakeJobs]]:
    """Makes the builds of one more execution."""
    folders = iter(tmp_path / f"execution-{number}" for number in range(10))

    def begin() -> tuple[GradedBuilds, FakeJobs]:
        folder = next(folders)
        folder.mkdir(mode=0o700)
        jobs = FakeJobs()
        return GradedBuilds(folder, jobs, ahead), jobs

    return begin


def built(builds: GradedBuilds, workspace: Path) -> Build:
    made = builds.build(describe_workspace(workspace), None)
    assert made.ok, made.log
    return made


def publish(packages: Path, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the course record the packages in a folder."""
    files = {
        str(path.relative_to(packages)): path.read_text() if path.is_file() else None
        for path in sorted(packages.rglob("*"))
    }
    chapter = root / "solutions" / "01_chapter"
    chapter.mkdir(parents=True)
    (chapter / BUILT_AHEAD).write_text(json.dumps([files]))
    monkeypatch.setattr(course, "root", lambda: root)
    monkeypatch.setattr(graded_builds, "_done", set())


@pytest.mark.parametrize("make", [python_package, interface_package])
def test_the_same_sources_are_built_again_for_a_classmate_and_for_a_second_execution(
    execution: Callable[[], tuple[GradedBuilds, FakeJobs]], tmp_path: Path, make: Callable[[Path], object]
) -> None:
    make(tmp_path / "ros2_ws" / "src" / "my_robot_interfaces")
    for _ in range(3):
        builds, jobs = execution()
        assert not built(builds, tmp_path / "ros2_ws").reused
        assert len(jobs.builds) == 1
        built(builds, tmp_path / "ros2_ws")
        assert len(jobs.builds) == 1  # the check after `colcon build` in the same notebook


def test_a_package_of_the_course_is_built_ahead_whatever_its_comments_say(
    execution: Callable[[], tuple[GradedBuilds, FakeJobs]],
    ahead: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    interface_package(tmp_path / "course" / "my_robot_interfaces", comment="# the course's\n")
    publish(tmp_path / "course", tmp_path, monkeypatch)
    jobs = FakeJobs()
    build_ahead(ahead, jobs)
    build_ahead(ahead, jobs)
    assert jobs.builds == [["my_robot_interfaces"]]
    assert "the course's" not in jobs.sources[0]

    interface_package(tmp_path / "ros2_ws" / "src" / "my_robot_interfaces", comment="# a student's\n")
    builds, jobs = execution()
    assert built(builds, tmp_path / "ros2_ws").install is not None
    assert not jobs.builds
    other = interface_package(tmp_path / "other" / "src" / "my_robot_interfaces")
    (other / "srv" / "AddTwoInts.srv").write_text("int32 a\n---\n")
    built(builds, tmp_path / "other")
    assert len(jobs.builds) == 1


def test_the_course_s_packages_with_other_comments_and_texts_are_put_together_without_a_build(
    execution: Callable[[], tuple[GradedBuilds, FakeJobs]],
    ahead: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    interface_package(tmp_path / "course" / "my_robot_interfaces", comment="# the course's\n")
    python_package(tmp_path / "course")
    publish(tmp_path / "course", tmp_path, monkeypatch)
    jobs = FakeJobs()
    build_ahead(ahead, jobs)
    assert jobs.builds == [["my_robot_interfaces"], ["tiny_pkg"]]
    assert "from the workspace" not in jobs.sources[1]

    interface_package(tmp_path / "ros2_ws" / "src" / "my_robot_interfaces", comment="# a student's\n")
    package = python_package(tmp_path / "ros2_ws" / "src")
    (package / "tiny_pkg" / "hello.py").write_text("# a student's\n")
    builds, jobs = execution()
    built(builds, tmp_path / "ros2_ws")
    assert not jobs.builds
    (package / "setup.py").write_text((package / "setup.py").read_text().replace("hello =", "hi ="))
    for _ in range(2):  # a classmate's setup.py, or that of an earlier execution, is not shared
        builds, jobs = execution()
        built(builds, tmp_path / "ros2_ws")
        assert jobs.builds == [["tiny_pkg"]]


def test_what_the_labs_write_is_recorded() -> None:
    """Else type: python -m tests.measure built_ahead."""
    written = dict(itertools.chain.from_iterable(map(_written_by, masters(course.root()))))
    assert "my_robot_interfaces/CMakeLists.txt" in written
    everything = [item for files in packages_to_build_ahead(course.root()) for item in files.items()]
    built = {path for path, _ in everything}  # not what no check builds, as the action of Lab 1.4
    assert len(built & written.keys()) > 4
    old = {path: text for path, text in written.items() if path in built and (path, text) not in everything}
    assert old == {}


def _written_by(master: Path) -> list[tuple[str, str]]:
    """The files of packages that the cells of a lab write, with the master's solutions."""
    cells = [_without_markers(cell.source) for cell in source_notebook(master).cells]
    head = "%%writefile ros2_ws/src/"
    found = [cell.removeprefix(head).partition("\n") for cell in cells if cell.startswith(head)]
    return [(path.strip(), text + "\n") for path, _, text in found]
