"""A student's own build: used for a check if it holds what the sources say, else built and the change named."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.builds.install_folder import LIBRARY
from autograder.workspaces.builds.students_builds import OwnBuilds, StudentsBuilds, changed_since, is_current
from autograder.workspaces.graded_builds import GradedBuilds
from autograder.workspaces.jobs import PlainJobs
from course_runtime.python_child import python_child

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import interface_package, python_package
from test_colcon import run_program
from test_grading_service import FakeJobs

if TYPE_CHECKING:
    from autograder.workspaces.builds.colcon_build import Build

SAYS = "hello from the workspace\n"


def colcon_build(workspace: Path, *options: str) -> None:
    """Build as a student does in a terminal."""
    command = python_child("-m", "colcon", "build", *options).command
    subprocess.run(command, cwd=workspace, env=os.environ, check=True, capture_output=True)


def module_of(workspace: Path) -> Path:
    return workspace / "src" / "tiny_pkg" / "tiny_pkg" / "hello.py"


def change(file: Path, old: str = "hello from", new: str = "good evening from") -> None:
    file.write_text(file.read_text().replace(old, new))


@pytest.fixture(scope="session")
def built_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that colcon has built, to be copied."""
    workspace = tmp_path_factory.mktemp("once") / "ros2_ws"
    python_package(workspace / "src")
    python_package(workspace / "src", "other_pkg")
    colcon_build(workspace)
    return workspace


@pytest.fixture
def built(built_once: Path, tmp_path: Path) -> Path:
    """A workspace that is as colcon has left it, with packages that know nothing of each other."""
    workspace = tmp_path / "built" / "ros2_ws"
    for name in ("src", "install", "build"):
        shutil.copytree(built_once / name, workspace / name, symlinks=True)
    as_if_built_now(workspace)
    return workspace


def as_if_built_now(workspace: Path) -> None:
    """Have the last build begin after the last change of all sources, and end after that of all that it made."""
    for folder, mark in (("src", "colcon_command_prefix_*.sh"), ("install", "colcon_build.rc")):
        last = max((workspace / folder).rglob("*"), key=lambda file: file.lstat().st_ctime_ns)
        for file in workspace.glob(f"build/*/{mark}"):
            touch_later(file, last)


def touch_later(file: Path, than: Path) -> None:
    """Touch a file until it is newer than another one: a file system's clock has ticks."""
    while not file.exists() or file.stat().st_mtime_ns <= than.lstat().st_ctime_ns:
        file.touch()


def the_package(_: Build) -> list[str]:
    return ["tiny_pkg"]


@pytest.fixture
def nothing_is_built(monkeypatch: pytest.MonkeyPatch) -> None:
    """A build for a check ends the test."""

    def refuse(*_: object) -> None:
        pytest.fail("it was built once more")

    monkeypatch.setattr(PlainJobs, "build", refuse)


def test_what_the_student_has_built_is_used(workspace: Path, request: pytest.FixtureRequest) -> None:
    colcon_build(workspace)
    request.getfixturevalue("nothing_is_built")
    made = StudentsBuilds().build(describe_workspace(workspace), None)
    assert (made.ok, made.install, made.changed) == (True, workspace / "install", "")
    assert made.programs("tiny_pkg") == ("hello",)
    assert run_program(made) == SAYS


@pytest.mark.usefixtures("nothing_is_built")
def test_only_the_packages_that_the_exercise_needs_are_in_it(built: Path) -> None:
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.install == built / "install"
    assert [prefix.name for prefix in made.prefixes] == ["tiny_pkg"]


def test_a_change_since_then_is_built_for_the_check_and_named(built: Path) -> None:
    change(module_of(built))
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.install != built / "install"
    assert made.changed == "`tiny_pkg/tiny_pkg/hello.py`"
    assert run_program(made) == "good evening from the workspace\n"
    colcon_build(built, "--packages-select", "tiny_pkg")
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert (made.install, made.changed) == (built / "install", "")


def test_the_change_is_named_even_if_it_cannot_be_built(built: Path) -> None:
    change(built / "src" / "tiny_pkg" / "setup.py", "version='0.0.0',", "version='0.0.0'")
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert (made.trouble, made.changed) == ("build", "`tiny_pkg/setup.py`")


def test_three_changes_are_named_and_the_others_counted(built: Path) -> None:
    for name in "abcde":
        module_of(built).with_name(f"{name}.py").write_text(name)
    first = ", ".join(f"`tiny_pkg/tiny_pkg/{name}.py`" for name in "abc")
    assert changed_since(built, describe_workspace(built).packages) == f"{first} and 2 more"


@pytest.mark.usefixtures("nothing_is_built")
def test_a_cell_that_writes_the_same_file_again_changes_nothing(built: Path) -> None:
    module_of(built).write_text(module_of(built).read_text())
    assert StudentsBuilds().build(describe_workspace(built), the_package).install == built / "install"


def test_a_file_that_is_put_there_with_an_old_date_is_a_change(built: Path, tmp_path: Path) -> None:
    old = tmp_path / "older.py"
    old.write_text("def main():\n    print('older')\n")
    os.utime(old, (1_000_000_000, 1_000_000_000))
    old.replace(module_of(built))
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.changed == "`tiny_pkg/tiny_pkg/hello.py`"
    assert run_program(made) == "older\n"


def test_links_show_a_changed_module_without_a_build_and_lead_elsewhere_once_they_are_copied(
    workspace: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    colcon_build(workspace, "--symlink-install")
    copied = tmp_path / "copied" / "ros2_ws"
    for name in ("src", "install", "build"):
        shutil.copytree(workspace / name, copied / name, symlinks=True)
    as_if_built_now(copied)
    assert not is_current(copied, describe_workspace(copied).packages)
    change(module_of(workspace))
    request.getfixturevalue("nothing_is_built")
    made = StudentsBuilds().build(describe_workspace(workspace), None)
    assert made.changed == ""
    assert run_program(made) == "good evening from the workspace\n"


def test_what_colcon_has_left_of_a_deleted_module_is_not_used(built: Path) -> None:
    assert is_current(built, describe_workspace(built).packages)
    (installed,) = (built / "install" / "tiny_pkg").rglob("hello.py")
    installed.with_name("helper.py").touch()
    assert not is_current(built, describe_workspace(built).packages)


def test_what_colcon_has_left_of_a_removed_entry_point_is_not_used(built: Path) -> None:
    change(built / "src" / "tiny_pkg" / "setup.py", "'hello = tiny_pkg.hello:main'", "")
    colcon_build(built, "--packages-select", "tiny_pkg")
    assert (built / "install" / "tiny_pkg" / "lib" / "tiny_pkg" / "hello").exists()
    assert StudentsBuilds().build(describe_workspace(built), the_package).programs("tiny_pkg") == ()


def test_what_colcon_has_left_of_a_launch_file_that_is_installed_elsewhere_now_is_not_used(
    built: Path,
) -> None:
    package = built / "src" / "tiny_pkg"
    (package / "launch").mkdir()
    (package / "launch" / "a.launch.py").touch()
    pairs = [
        f"('{folder}', ['launch/a.launch.py'])," for folder in ("share/tiny_pkg", "share/tiny_pkg/launch")
    ]
    change(package / "setup.py", "['package.xml']),", f"['package.xml']), {pairs[0]}")
    colcon_build(built, "--packages-select", "tiny_pkg")
    assert is_current(built, describe_workspace(built).packages)
    change(package / "setup.py", *pairs)
    colcon_build(built, "--packages-select", "tiny_pkg")
    assert len(list((built / "install" / "tiny_pkg" / "share").rglob("a.launch.py"))) == 2
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.launch_files("tiny_pkg") == (Path("share/tiny_pkg/launch/a.launch.py"),)


def test_an_installed_file_that_was_changed_since_the_build_is_not_used(built: Path) -> None:
    assert is_current(built, describe_workspace(built).packages)
    touch_later(built / "later", built / "build" / "tiny_pkg" / "colcon_build.rc")
    program = built / "install" / "tiny_pkg" / "lib" / "tiny_pkg" / "hello"
    program.write_text(f"#!{sys.executable}\nprint('by hand')\n")
    assert not is_current(built, describe_workspace(built).packages)


def test_a_build_that_failed_is_not_used(built: Path) -> None:
    (built / "build" / "tiny_pkg" / "colcon_build.rc").write_text("1\n")
    assert not is_current(built, describe_workspace(built).packages)


def test_a_merged_install_is_not_used(built: Path) -> None:
    (built / "install" / ".colcon_install_layout").write_text("merged\n")
    assert not is_current(built, describe_workspace(built).packages)


def test_what_a_notebook_asks_to_be_built_is_built(built: Path) -> None:
    assert OwnBuilds().build(describe_workspace(built), the_package).install != built / "install"


def test_a_class_builds_again(built: Path, tmp_path: Path) -> None:
    assert is_current(built, describe_workspace(built).packages)
    (tmp_path / "execution").mkdir(mode=0o700)
    builds = GradedBuilds(tmp_path / "execution", jobs := FakeJobs())
    made = builds.build(describe_workspace(built), the_package)
    assert made.install != built / "install"
    assert jobs.builds == [["tiny_pkg"]]


@pytest.mark.parametrize(
    ("cached", "current"),
    [("CMAKE_BUILD_TYPE:STRING=Release\n", True), ("CMAKE_BUILD_TYPE:STRING=\n", False), (None, False)],
)
def test_interfaces_are_used_if_they_are_built_as_in_a_class(
    tmp_path: Path, cached: str | None, current: bool
) -> None:
    """A build of interfaces takes ten seconds, so what colcon leaves of one is written here."""
    workspace, name = tmp_path / "ros2_ws", "my_robot_interfaces"
    source = interface_package(workspace / "src" / name)
    build, prefix = workspace / "build" / name, workspace / "install" / name
    for folder in (build, prefix / LIBRARY / name, prefix / "share" / name / "srv"):
        folder.mkdir(parents=True)
    (workspace / "install" / ".colcon_install_layout").write_text("isolated\n")
    touch_later(build / "colcon_command_prefix_build.sh", source / "LICENSE")
    if cached is not None:
        (build / "CMakeCache.txt").write_text(cached)
    definition = Path("srv", "AddTwoInts.srv")
    shutil.copy(source / definition, prefix / "share" / name / definition)
    (build / "colcon_build.rc").write_text("0\n")
    assert is_current(workspace, describe_workspace(workspace).packages) is current
    touch_later(tmp_path / "later", build / "colcon_command_prefix_build.sh")
    (source / definition).write_text("int64 a\n---\nint64 sum\n")
    assert not is_current(workspace, describe_workspace(workspace).packages)
    assert changed_since(workspace, describe_workspace(workspace).packages) == f"`{name}/{definition}`"
