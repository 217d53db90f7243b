"""Building: real once, reused for the same bytes, and a failure told in one line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.builds import students_builds
from autograder.workspaces.builds.colcon_build import CannotCopyBuild, copy_to_workspace, describe_workspace
from autograder.workspaces.builds.install_folder import with_prefixes

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import interface_package, python_package

from tests.cases import cases

if TYPE_CHECKING:
    from autograder.workspaces.builds.colcon_build import Build, Targets


def build(workspace: Path, targets: Targets | None = None) -> Build:
    """What comes of building a folder."""
    return students_builds.StudentsBuilds().build(describe_workspace(workspace), targets)


def run_program(made: Build) -> str:
    """What the program of the package prints in the environment of the build."""
    program = made.prefixes[0] / "lib" / "tiny_pkg" / "hello"
    environment = with_prefixes(os.environ, made.prefixes)
    return subprocess.run(
        [sys.executable, str(program)], env=environment, capture_output=True, text=True, check=True
    ).stdout


def assert_that_it_can_be_placed_and_sourced(made: Build) -> None:
    install = copy_to_workspace(made)
    script = (
        f"source '{install}/setup.bash' && \"$AMENT_PREFIX_PATH_FIRST\" 2>/dev/null; echo $AMENT_PREFIX_PATH"
    )
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split(":")[0].strip() == str(install / "tiny_pkg")
    texts = [file.read_bytes() for file in install.rglob("*") if file.is_file()]
    assert not any(str(made.install).encode() in text for text in texts)


def test_the_first_build_is_real_and_the_second_is_reused_and_can_be_placed(workspace: Path) -> None:
    first = build(workspace)
    assert first.ok, first.log
    assert not first.reused
    assert run_program(first) == "hello from the workspace\n"
    second = build(workspace)
    assert second.reused
    assert second.install == first.install
    assert not (workspace / "install").exists()
    assert_that_it_can_be_placed_and_sourced(second)


def test_a_changed_byte_is_another_build(workspace: Path) -> None:
    first = build(workspace)
    module = workspace / "src" / "tiny_pkg" / "tiny_pkg" / "hello.py"
    module.write_text(module.read_text().replace("hello from", "good evening from"))
    second = build(workspace)
    assert not second.reused
    assert run_program(second) == "good evening from the workspace\n"
    assert run_program(first) == "hello from the workspace\n"


def test_what_an_earlier_build_left_behind_has_no_part_in_it(workspace: Path) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    copy_to_workspace(build(workspace))
    setup.write_text(setup.read_text().replace("'hello = tiny_pkg.hello:main'", ""))
    made = build(workspace)
    assert made.ok
    assert not (made.prefixes[0] / "lib" / "tiny_pkg" / "hello").exists()


def test_a_failure_is_one_line_and_is_not_kept(workspace: Path, empty_cache: Path) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    good = setup.read_text()
    setup.write_text(good.replace("version='0.0.0',", "version='0.0.0'"))
    made = build(workspace)
    assert (made.ok, made.trouble, made.package) == (False, "build", "tiny_pkg")
    assert made.line.startswith("setup.py:")
    assert "SyntaxError" in made.line
    assert "SyntaxError" in made.log
    assert [entry for entry in empty_cache.iterdir() if entry.is_dir()] == []
    setup.write_text(good)
    assert build(workspace).ok


@pytest.mark.parametrize(
    ("old", "new", "trouble", "words"), cases(__file__, "what_setuptools_refuses_without_a_word_is_named")
)
def test_what_setuptools_refuses_without_a_word_is_named(
    workspace: Path, old: str, new: str, trouble: str, words: str
) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    setup.write_text(setup.read_text().replace(old, new))
    made = build(workspace)
    assert (made.ok, made.trouble, made.package) == (False, trouble, "tiny_pkg")
    assert words in made.line


@pytest.mark.parametrize(
    ("make", "trouble", "word"),
    [
        (lambda folder: None, "no_workspace", "no folder"),
        (lambda folder: folder.mkdir(), "no_workspace", "src"),
        (lambda folder: (folder / "src").mkdir(parents=True), "no_package", "package.xml"),
    ],
    ids=["nothing", "no src", "empty src"],
)
def test_what_is_no_workspace_says_so(tmp_path: Path, make: object, trouble: str, word: str) -> None:
    folder = tmp_path / "nothing_ws"
    make(folder)  # type: ignore[operator]
    made = build(folder)
    assert (made.ok, made.trouble) == (False, trouble)
    assert word in made.line


def test_a_package_that_colcon_would_mistake_is_named(workspace: Path) -> None:
    file = workspace / "src" / "tiny_pkg" / "package.xml"
    file.write_text(file.read_text().replace(' email="student@example.com"', ""))
    made = build(workspace)
    assert made.trouble == "bad_package"
    assert "email" in made.line


def test_a_merged_install_is_left_alone(workspace: Path) -> None:
    made = build(workspace)
    (workspace / "install").mkdir()
    (workspace / "install" / ".colcon_install_layout").write_text("merged\n")
    with pytest.raises(CannotCopyBuild, match="delete it"):
        copy_to_workspace(made)


def test_packages_of_others_stay(workspace: Path) -> None:
    other = workspace / "install" / "other_pkg" / "share"
    other.mkdir(parents=True)
    copy_to_workspace(build(workspace))
    copy_to_workspace(build(workspace))
    assert other.is_dir()
    assert (workspace / "install" / "tiny_pkg" / "lib" / "tiny_pkg" / "hello").is_file()
    assert not list((workspace / "install").glob(".new-*"))


def only_tiny(found: Build) -> list[str]:
    return [package.name for package in found.packages if package.name == "tiny_pkg"]


def test_what_is_half_done_beside_the_package_hurts_only_who_needs_it(workspace: Path) -> None:
    other = python_package(workspace / "src", "other_pkg")
    (other / "setup.py").write_text("setup(")
    assert build(workspace).package == "other_pkg"
    made = build(workspace, only_tiny)
    assert made.ok, made.log
    assert [prefix.name for prefix in made.prefixes] == ["tiny_pkg"]
    (other / "package.xml").write_text("<package>")
    assert build(workspace).trouble == "bad_package"
    assert build(workspace, only_tiny).reused


@pytest.mark.ros
@pytest.mark.slow
def test_of_interfaces_all_is_built_that_a_node_needs(tmp_path: Path) -> None:
    package = interface_package(tmp_path / "src" / "note_interfaces")
    (package / "msg").mkdir()
    (package / "msg" / "Note.msg").write_text("string[] lines\n")
    for name in ("CMakeLists.txt", "package.xml"):
        text = (package / name).read_text().replace("my_robot_interfaces", "note_interfaces")
        (package / name).write_text(text.replace('"srv/', '"msg/Note.msg" "srv/'))
    made = build(tmp_path)
    assert made.ok, made.log
    # A topic needs more than a service: Fast DDS describes its type to others.
    node = cases(__file__, "of_interfaces_all_is_built_that_a_node_needs")
    subprocess.run([sys.executable, "-c", node], env=with_prefixes(os.environ, made.prefixes), check=True)


def test_what_a_package_depends_on_may_fail_where_it_is_not_asked_for(workspace: Path) -> None:
    other = python_package(workspace / "src", "other_pkg")
    (other / "setup.py").write_text("setup(")
    file = workspace / "src" / "tiny_pkg" / "package.xml"
    file.write_text(file.read_text().replace("<license>", "<depend>other_pkg</depend>\n  <license>"))
    made = build(workspace, only_tiny)
    assert made.ok, made.log
    assert [prefix.name for prefix in made.prefixes] == ["tiny_pkg"]
    assert [package.name for package in made.packages] == ["other_pkg", "tiny_pkg"]
    assert build(workspace).package == "other_pkg"
    (workspace / "src" / "tiny_pkg" / "setup.py").write_text("setup(")
    assert not build(workspace, only_tiny).ok


def test_a_package_that_may_be_the_one_that_is_needed_is_no_neighbour(workspace: Path) -> None:
    (python_package(workspace / "src", "other_pkg") / "package.xml").write_text("<package>")
    assert build(workspace, lambda _: []).trouble == "bad_package"
