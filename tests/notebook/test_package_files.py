"""Lines are added to a package's files once, whatever is there and however often it is asked for."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

import pytest

from autograder.notebook.package_files import (
    add_data_files,
    add_definition,
    add_dependencies,
    add_entry_points,
)
from course_runtime.ros2_command import pkg_templates
from course_runtime.ros2_command.pkg_templates import Package
from tests.cases import named_cases

if TYPE_CHECKING:
    from pathlib import Path

INTERFACES = "my_robot_interfaces"
TALKER = "talker = my_robot_pkg.talker:main"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    package = tmp_path / "src" / "my_robot_pkg"
    package.mkdir(parents=True)
    who = ("TODO: what it is", "Apache-2.0", "me", "me@example.com")
    made = Package("my_robot_pkg", "ament_python", 3, *who, ("rclpy", "std_msgs"), None)
    (package / "setup.py").write_text(pkg_templates.setup_py(made))
    (package / "package.xml").write_text(pkg_templates.package_xml(made))
    interfaces = tmp_path / "src" / "my_robot_interfaces"
    (interfaces / "action").mkdir(parents=True)
    (interfaces / "CMakeLists.txt").write_text(
        'project(x)\nrosidl_generate_interfaces(${PROJECT_NAME} "srv/AddTwoInts.srv")\nament_package()\n'
    )
    (interfaces / "package.xml").write_text("<package>\n  <export>\n  </export>\n</package>\n")
    return tmp_path


def executables(workspace: Path) -> list[str]:
    tree = ast.parse((workspace / "src/my_robot_pkg/setup.py").read_text())
    (keyword,) = (n for n in ast.walk(tree) if isinstance(n, ast.keyword) and n.arg == "entry_points")
    found: dict[str, list[str]] = ast.literal_eval(keyword.value)
    return found["console_scripts"]


@pytest.mark.parametrize("case", named_cases(__file__, "what_becomes_of_entry_points"))
def test_what_becomes_of_entry_points(workspace: Path, case: dict[str, Any]) -> None:
    setup = workspace / "src/my_robot_pkg/setup.py"
    setup.write_text(case.get("setup", setup.read_text()))
    before = setup.read_text()
    said = [add_entry_points(workspace, entries) for entries in case["adds"]]
    assert [text for text in case.get("says", ()) if text not in said[-1]] == []
    assert [text for text in case.get("hides", ()) if text in said[-1]] == []
    after = setup.read_text()
    assert [text for text in case.get("keeps", ()) if text not in after] == []
    if "executables" in case:
        assert tuple(executables(workspace)) == case["executables"]
    elif "keeps" not in case:
        assert after == before
    ast.parse(after)
    add_entry_points(workspace, case["adds"][-1])
    assert setup.read_text() == after


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "First make the package"),
        ("setup(", "cannot be read"),
        ("setup()", "has no list"),
        (b"# caf\xe9", "cannot be read"),
        ("a = 1\0", "cannot be read"),
    ],
)
def test_a_setup_that_cannot_be_used(workspace: Path, text: str | bytes | None, words: str) -> None:
    setup = workspace / "src/my_robot_pkg/setup.py"
    if text is None:
        setup.unlink()
    else:
        setup.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert words in add_entry_points(workspace, [TALKER])


def test_a_dependency_is_added_once(workspace: Path) -> None:
    for _ in range(2):
        said = add_dependencies(workspace, ["my_robot_interfaces", "std_msgs"])
    assert said == "Dependencies of my_robot_pkg: rclpy, std_msgs, my_robot_interfaces"
    text = (workspace / "src/my_robot_pkg/package.xml").read_text()
    assert text.count("<depend>my_robot_interfaces</depend>") == 1
    assert text.index("my_robot_interfaces") < text.index("<export>")
    assert "First make" in add_dependencies(workspace, ["a"], package="nobody")


def test_a_definition_is_generated_once_it_is_written(workspace: Path) -> None:
    folder = workspace / "src/my_robot_interfaces"
    action = "action/Fibonacci.action"
    assert add_definition(workspace, INTERFACES, action) == f"{action} is not written yet."
    (folder / action).write_text("# TODO\n")
    assert "not written yet" in add_definition(workspace, INTERFACES, action)
    (folder / action).write_text("int32 order\n---\nint32[] sequence\n---\nint32[] partial_sequence\n")
    for _ in range(2):
        said = add_definition(workspace, INTERFACES, action, ["action_msgs"])
    assert "generates: srv/AddTwoInts.srv, action/Fibonacci.action" in said
    assert (folder / "CMakeLists.txt").read_text().count("Fibonacci") == 1
    assert (folder / "package.xml").read_text().count("<depend>action_msgs</depend>") == 1
    (folder / "CMakeLists.txt").write_text("project(x)\n")
    assert "generates nothing yet" in add_definition(workspace, INTERFACES, action)


LAUNCH = ("share/my_robot_pkg/launch", ["launch/remap.launch.py"])


def data_files(workspace: Path) -> list[str]:
    tree = ast.parse((workspace / "src/my_robot_pkg/setup.py").read_text())
    (keyword,) = (n for n in ast.walk(tree) if isinstance(n, ast.keyword) and n.arg == "data_files")
    assert isinstance(keyword.value, ast.List)
    return [ast.unparse(pair) for pair in keyword.value.elts]


def test_data_files_are_added_once_below_those_of_the_package(workspace: Path) -> None:
    own = data_files(workspace)
    add_entry_points(workspace, [TALKER])
    said = add_data_files(workspace, [LAUNCH])
    assert data_files(workspace) == [*own, repr(LAUNCH)]
    assert said.splitlines()[0] == "my_robot_pkg installs:"
    assert said.splitlines()[-1] == f"  {LAUNCH!r}"
    setup = (workspace / "src/my_robot_pkg/setup.py").read_text()
    add_data_files(workspace, [LAUNCH])
    add_entry_points(workspace, [TALKER])
    assert (workspace / "src/my_robot_pkg/setup.py").read_text() == setup


def test_corrected_data_files_replace_the_wrong_ones_and_no_others(workspace: Path) -> None:
    own = data_files(workspace)
    setup = workspace / "src/my_robot_pkg/setup.py"
    setup.write_text(
        setup.read_text().replace("data_files=[", "data_files=[('share/mine', glob('*.txt')),  # mine")
    )
    add_data_files(workspace, [("share/my_robot_pkg/lunch", ["remap.launch.py"])])
    add_data_files(workspace, [LAUNCH])
    assert data_files(workspace) == ["('share/mine', glob('*.txt'))", *own, repr(LAUNCH)]
    assert "# mine" in setup.read_text()
    add_data_files(workspace, [])
    assert data_files(workspace) == ["('share/mine', glob('*.txt'))", *own]


@pytest.mark.parametrize(
    "pair", ["launch", ("share/my_robot_pkg/launch", "launch/remap.launch.py"), ("share", [1]), ("share",), 3]
)
def test_what_is_no_pair_of_a_folder_and_files_changes_nothing(workspace: Path, pair: object) -> None:
    before = (workspace / "src/my_robot_pkg/setup.py").read_text()
    assert "square brackets around the files" in add_data_files(workspace, [LAUNCH, pair])  # type: ignore[list-item]
    assert (workspace / "src/my_robot_pkg/setup.py").read_text() == before


@pytest.mark.parametrize(
    ("text", "words"), [(None, "First make"), ("setup(", "cannot be read"), ("setup()", "no list")]
)
def test_a_setup_to_which_no_data_files_can_be_added(workspace: Path, text: str | None, words: str) -> None:
    setup = workspace / "src/my_robot_pkg/setup.py"
    setup.unlink() if text is None else setup.write_text(text)
    assert words in add_data_files(workspace, [LAUNCH])
