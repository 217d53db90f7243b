"""A student's own workspace: the check builds its sources, and names what changed since the last `colcon build`."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.builds.students_builds import StudentsBuilds, changed_since
from course_runtime.python_child import python_child

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import interface_package, python_package
from test_colcon import run_program

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
    """Have the last build begin after the last change of all sources."""
    last = max((workspace / "src").rglob("*"), key=lambda file: file.lstat().st_ctime_ns)
    for file in workspace.glob("build/*/colcon_command_prefix_*.sh"):
        touch_later(file, last)


def touch_later(file: Path, than: Path) -> None:
    """Touch a file until it is newer than another one: a file system's clock has ticks."""
    while not file.exists() or file.stat().st_mtime_ns <= than.lstat().st_ctime_ns:
        file.touch()


def the_package(_: Build) -> list[str]:
    return ["tiny_pkg"]


def changed_in(workspace: Path) -> str:
    return changed_since(workspace, describe_workspace(workspace).packages)


def test_the_sources_are_built_even_if_the_student_has_just_built_them(built: Path) -> None:
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.install is not None
    assert not made.install.is_relative_to(built)
    assert ([prefix.name for prefix in made.prefixes], made.changed) == (["tiny_pkg"], "")
    assert run_program(made) == SAYS


def test_a_change_since_then_is_built_for_the_check_and_named(built: Path) -> None:
    change(module_of(built))
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert made.changed == "`tiny_pkg/tiny_pkg/hello.py`"
    assert run_program(made) == "good evening from the workspace\n"
    colcon_build(built, "--packages-select", "tiny_pkg")
    assert not changed_in(built)


def test_the_change_is_named_even_if_it_cannot_be_built(built: Path) -> None:
    change(built / "src" / "tiny_pkg" / "setup.py", "version='0.0.0',", "version='0.0.0'")
    made = StudentsBuilds().build(describe_workspace(built), the_package)
    assert (made.trouble, made.changed) == ("build", "`tiny_pkg/setup.py`")


def test_three_changes_are_named_and_the_others_counted(built: Path) -> None:
    for name in "abcde":
        module_of(built).with_name(f"{name}.py").write_text(name)
    first = ", ".join(f"`tiny_pkg/tiny_pkg/{name}.py`" for name in "abc")
    assert changed_in(built) == f"{first} and 2 more"


def test_a_cell_that_writes_the_same_file_again_changes_nothing(built: Path) -> None:
    module_of(built).write_text(module_of(built).read_text())
    assert not changed_in(built)


def test_a_file_that_is_put_there_with_an_old_date_is_a_change(built: Path, tmp_path: Path) -> None:
    old = tmp_path / "older.py"
    old.write_text("def main():\n    print('older')\n")
    os.utime(old, (1_000_000_000, 1_000_000_000))
    old.replace(module_of(built))
    assert changed_in(built) == "`tiny_pkg/tiny_pkg/hello.py`"


def test_links_show_a_changed_module_without_a_build(workspace: Path) -> None:
    colcon_build(workspace, "--symlink-install")
    change(module_of(workspace))
    assert not changed_in(workspace)
    change(workspace / "src" / "tiny_pkg" / "setup.py", "0.0.0", "0.0.1")
    assert changed_in(workspace) == "`tiny_pkg/setup.py`"


def test_a_package_that_was_never_built_has_no_changes(workspace: Path) -> None:
    assert not changed_in(workspace)


def test_a_changed_definition_is_named(tmp_path: Path) -> None:
    """A build of interfaces takes ten seconds, so what colcon leaves of one is written here."""
    workspace, name = tmp_path / "ros2_ws", "my_robot_interfaces"
    source = interface_package(workspace / "src" / name)
    build, prefix = workspace / "build" / name, workspace / "install" / name
    definition = Path("srv", "AddTwoInts.srv")
    for folder in (build, prefix / "share" / name / "srv"):
        folder.mkdir(parents=True)
    touch_later(build / "colcon_command_prefix_build.sh", source / "LICENSE")
    assert not changed_in(workspace)
    touch_later(tmp_path / "later", build / "colcon_command_prefix_build.sh")
    (source / definition).write_text("int64 a\n---\nint64 sum\n")
    assert changed_in(workspace) == f"`{name}/{definition}`"
