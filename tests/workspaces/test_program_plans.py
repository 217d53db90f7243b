"""Whose programs a launch file starts: the student's own or, where there are none, the course's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.runners import ALONE, LaunchesFromPackage
from autograder.workspaces.builds.cached_builds import Builds
from autograder.workspaces.builds.colcon_build import Build
from autograder.workspaces.jobs import PlainJobs
from autograder.workspaces.packages import Package
from autograder.workspaces.program_plans import lacks_programs, launch_targets, plan_for
from tests.cases import cases

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
    ("programs", "text", "lacking"), cases(__file__, "the_course_s_programs_stand_in_for_missing_ones")
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


def test_lent_programs_are_in_one_folder_with_the_student_s_launch_files(tmp_path: Path) -> None:
    """ROS finds a package in one prefix only: there a launch file looks for the file that it includes."""
    own, course = (
        installed(tmp_path / "own", f"{SHARE}/launch/both.launch.py", programs=()),
        tmp_path / "course",
    )
    lent = Builds(tmp_path, PlainJobs({}, handed_in=True)).lend(own, built(course, "talker", "listener"))
    (prefix,) = lent.prefixes
    assert (prefix / SHARE / "launch" / "both.launch.py").is_file()
    assert lent.programs(PACKAGE) == ("listener", "talker")


def installed(workspace: Path, *files: str, programs: tuple[str, ...] = ("talker", "listener")) -> Build:
    """A workspace whose package has installed these files."""
    made = built(workspace, *programs)
    for name in files:
        file = workspace / "install" / PACKAGE / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    return made


INSTALLED = LaunchesFromPackage(PACKAGE, "remap.launch")
SHARE = f"share/{PACKAGE}"


@pytest.mark.parametrize(
    ("files", "missing", "launched"), cases(__file__, "what_the_package_has_installed_is_launched")
)
def test_what_the_package_has_installed_is_launched(
    files: tuple[str, ...], missing: str, launched: str, tmp_path: Path
) -> None:
    made = installed(tmp_path, *files)
    plan = plan_for(INSTALLED)
    assert plan.missing(made) == missing
    file = tmp_path / "install" / PACKAGE / launched if launched else None
    assert plan.launches(made) == file
    assert file is None or plan.command(made)[1:] == ["launch", PACKAGE, file.name]


def test_of_two_installed_files_of_one_name_ros2_launch_itself_complains(tmp_path: Path) -> None:
    made = installed(tmp_path, f"{SHARE}/launch/remap.launch.py", f"{SHARE}/remap.launch.py")
    assert plan_for(INSTALLED).command(made)[1:] == ["launch", PACKAGE, "remap.launch.py"]


def test_a_package_that_is_not_built_is_missing_and_a_program_runs_in_place_of_a_launch(
    tmp_path: Path,
) -> None:
    made = installed(tmp_path, f"{SHARE}/launch/remap.launch.py")
    assert plan_for(LaunchesFromPackage("other", "remap.launch")).missing(made) == "other"
    assert plan_for(INSTALLED, (ALONE, PACKAGE, "talker")).command(made)[1:] == ["run", PACKAGE, "talker"]


def test_the_packages_that_a_launch_file_in_a_package_names_are_built_as_well(tmp_path: Path) -> None:
    own = built(tmp_path, "talker")
    names = ("chat_pkg", "half_done_pkg")
    others = tuple(Package(name, tmp_path / "src" / name, "ament_python") for name in names)
    found = Build(tmp_path, ok=False, packages=(*own.packages, *others))
    (own.packages[0].folder / "launch" / "remap.launch.py").write_text("Node(package='chat_pkg')")
    assert plan_for(INSTALLED).targets(found) == [PACKAGE, "chat_pkg"]
