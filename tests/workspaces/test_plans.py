"""Whose programs a launch file starts: the student's own or, where there are none, the course's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.colcon import Build
from autograder.workspaces.packages import Package
from autograder.workspaces.plans import lacks_programs, launch_targets

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE = "my_robot_pkg"


def built(workspace: Path, *programs: str) -> Build:
    """A workspace with a package of these programs."""
    folder, prefix = workspace / "src" / PACKAGE, workspace / "install" / PACKAGE
    (folder / "launch").mkdir(parents=True)
    (prefix / "share").mkdir(parents=True)
    (prefix / "lib" / PACKAGE).mkdir(parents=True)
    for program in programs:
        (prefix / "lib" / PACKAGE / program).touch()
    package = Package(PACKAGE, folder, "ament_python")
    return Build(workspace, ok=True, install=prefix.parent, packages=(package,))


@pytest.mark.parametrize(
    ("programs", "text", "lacking"),
    [
        ("", "Node(executable='talker'), Node(executable='listener')", True),
        ("talker", "Node(executable='talker'), Node(executable='listener')", True),
        ("talker listener", "Node(executable='talker'), Node(executable='listener')", False),
        ("speak hear", "talker = Node(executable='speak'); listener = Node(executable='hear')", False),
        ("talker hear", "[Node(executable='talker'), Node(executable='hear')]  # the listener", False),
        ("node", '<node exec="talker"/><node exec="listener"></node>', True),
        ("node", "- node: {exec: talker}\n- node: {exec: listener}", True),
    ],
)
def test_the_course_s_programs_stand_in_for_missing_ones(
    programs: str, text: str, lacking: bool, tmp_path: Path
) -> None:
    own = built(tmp_path / "own", *programs.split())
    course = built(tmp_path / "course", "talker", "listener")
    file = tmp_path / "remap.launch"
    file.write_text(text)
    assert lacks_programs(file, own, course) == lacking


def test_what_a_launch_file_includes_belongs_to_it(tmp_path: Path) -> None:
    own = built(tmp_path / "own", "speak", "hear")
    course = built(tmp_path / "course", "talker", "listener")
    inner = own.packages[0].folder / "launch" / "chat.launch.py"
    inner.write_text(f"Node(package='{PACKAGE}', executable='speak')  # included by remap.launch.xml")
    file = tmp_path / "remap.launch.xml"
    file.write_text('<include file="$(dirname)/chat.launch.py"/> <!-- talker and listener -->')
    assert not lacks_programs(file, own, course)
    assert list(launch_targets(file)(own)) == [PACKAGE]


def test_in_launch_files_that_are_far_too_long_nothing_is_taken_for_missing(tmp_path: Path) -> None:
    own = built(tmp_path / "own", "speak", "hear")
    course = built(tmp_path / "course", "talker", "listener")
    folder = own.packages[0].folder / "launch"
    for number in range(3):
        words = f"'talker' {number + 1}.launch.py" + f" {'x' * 99}" * 2_000
        (folder / f"{number}.launch.py").write_text(words)
    file = folder / "0.launch.py"
    assert not lacks_programs(file, own, course)
    assert list(launch_targets(file)(own)) == [PACKAGE]
    (folder / "2.launch.py").unlink()
    assert lacks_programs(file, own, course)
    assert list(launch_targets(file)(own)) == []
