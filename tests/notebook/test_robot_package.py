"""Completing a student's package changes what is missing and nothing else."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import pytest

from autograder import course
from autograder.notebook.robot_package import complete_package
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

SETUP = cases(__file__, "SETUP")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """A package as the course has one."""
    folder = tmp_path / "source"
    (folder / "my_robot_pkg").mkdir(parents=True)
    (folder / "package.xml").write_text("<package/>")
    (folder / "setup.py").write_text("course")
    for name in ("talker", "listener"):
        (folder / "my_robot_pkg" / f"{name}.py").write_text(f"class {name}:  # the course's")
    return folder


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A student's package after lab 1.1."""
    folder = tmp_path / "ros2_ws/src/my_robot_pkg"
    (folder / "my_robot_pkg").mkdir(parents=True)
    (folder / "package.xml").write_text("<package/>")
    (folder / "setup.py").write_text(SETUP % "            'simple_node = my_robot_pkg.simple_node:main',\n")
    return folder


def entries(package: Path) -> list[str]:
    tree = ast.parse((package / "setup.py").read_text())
    (programs,) = (node for node in ast.walk(tree) if isinstance(node, ast.List))
    return [ast.literal_eval(element) for element in programs.elts]


def test_without_a_package_the_courses_own_is_taken(tmp_path: Path, source: Path) -> None:
    assert "no my_robot_pkg" in complete_package(tmp_path / "ros2_ws", source)
    assert (tmp_path / "ros2_ws/src/my_robot_pkg/setup.py").read_text() == "course"


def test_what_is_missing_is_added_once(tmp_path: Path, source: Path, package: Path) -> None:
    assert (
        complete_package(tmp_path / "ros2_ws", source) == "Added to your my_robot_pkg: talker and listener."
    )
    assert entries(package) == [
        "simple_node = my_robot_pkg.simple_node:main",
        "talker = my_robot_pkg.talker:main",
        "listener = my_robot_pkg.listener:main",
    ]
    assert (package / "my_robot_pkg/talker.py").read_text() == "class talker:  # the course's"
    assert "Nothing was changed" in complete_package(tmp_path / "ros2_ws", source)
    assert len(entries(package)) == 3


def test_what_the_student_wrote_stays(tmp_path: Path, source: Path, package: Path) -> None:
    (package / "setup.py").write_text(SETUP % '            "talker=my_robot_pkg.mine:main",\n')
    (package / "my_robot_pkg/listener.py").write_text("class Mine: ...")
    assert complete_package(tmp_path / "ros2_ws", source) == "Added to your my_robot_pkg: listener."
    assert entries(package) == ["talker=my_robot_pkg.mine:main", "listener = my_robot_pkg.listener:main"]
    assert (package / "my_robot_pkg/listener.py").read_text() == "class Mine: ..."
    assert not (package / "my_robot_pkg/talker.py").exists()


def test_a_program_into_which_nothing_was_copied_is_missing(
    tmp_path: Path, source: Path, package: Path
) -> None:
    (package / "setup.py").write_text(SETUP % '            "talker = my_robot_pkg.talker:main",\n')
    (package / "my_robot_pkg/talker.py").write_text("# TODO: copy your class TalkerNode to this place.\n")
    complete_package(tmp_path / "ros2_ws", source)
    assert (package / "my_robot_pkg/talker.py").read_text() == "class talker:  # the course's"


def test_an_entry_point_in_a_comment_does_not_count(tmp_path: Path, source: Path, package: Path) -> None:
    (package / "setup.py").write_text(SETUP % "            # 'talker = my_robot_pkg.talker:main',\n")
    assert "talker and listener" in complete_package(tmp_path / "ros2_ws", source)


def test_a_setup_without_the_list_is_left_alone(tmp_path: Path, source: Path, package: Path) -> None:
    (package / "setup.py").write_text("from setuptools import setup\n\nsetup()\n")
    said = complete_package(tmp_path / "ros2_ws", source)
    assert "no list of console_scripts" in said
    assert '"talker = my_robot_pkg.talker:main"' in said
    assert (package / "setup.py").read_text() == "from setuptools import setup\n\nsetup()\n"


def test_without_the_courses_own_package_a_finished_one_is_told_apart(
    tmp_path: Path, source: Path, package: Path
) -> None:
    """As in what students are handed."""
    nowhere = tmp_path / "no_solutions"
    said = complete_package(tmp_path / "ros2_ws", nowhere)
    assert "no program talker and no program listener yet. Do Lab 1.2 first" in said
    complete_package(tmp_path / "ros2_ws", source)
    assert (
        complete_package(tmp_path / "ros2_ws", nowhere)
        == "Your my_robot_pkg has the programs talker and listener."
    )


def test_where_there_is_no_course_nothing_of_it_is_taken(
    tmp_path: Path, package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in the box of a graded notebook: the check brings the course's own programs by itself."""
    monkeypatch.setenv(course.VARIABLE, str(tmp_path))
    assert "graded alone" in complete_package(tmp_path / "ros2_ws")
    assert not (package / "my_robot_pkg/talker.py").exists()
