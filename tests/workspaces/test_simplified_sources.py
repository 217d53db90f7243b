"""Texts of interface packages that mean the same become the same; where that is not certain they stay as they are."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from rosidl_adapter.parser import InvalidSpecification, parse_service_string

from autograder.messages.workspace_messages import Source
from autograder.workspaces.builds.simplified_sources import simplified
from autograder.workspaces.packages import sources_of
from autograder.workspaces.sources import SourceTree

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import CMAKE, DEFINITION, INTERFACE_PACKAGE_XML, interface_package, packages_in


def simple_text(name: str, text: str) -> str:
    (source,) = simplified(SourceTree((Source(f"p/{name}", text.encode()),))).sources
    assert source.data is not None
    return source.data.decode()


@pytest.mark.parametrize(
    "text",
    [
        "# what I thought\n" + CMAKE,
        CMAKE.replace("${PROJECT_NAME} ", "\n  ${PROJECT_NAME}\n    "),
        CMAKE.replace("(", " ( ").replace(")", " )  # so"),
        CMAKE.replace("\n\n", "\n\n\n\n"),
        CMAKE.replace("\n", "\r\n"),
    ],
    ids=["comment", "lines", "spaces", "blank lines", "another system's line ends"],
)
def test_what_means_the_same_to_cmake_becomes_the_same(text: str) -> None:
    assert text != CMAKE
    assert simple_text("CMakeLists.txt", text) == simple_text("CMakeLists.txt", CMAKE)


@pytest.mark.parametrize(
    "text",
    [
        CMAKE.replace("REQUIRED", "", 1),
        CMAKE.replace("ament_package", "ament_packages"),
        CMAKE.replace("find_package(r", "#find_package(r"),
        CMAKE.replace('"srv/AddTwoInts.srv"', '"srv/Add TwoInts.srv"'),
        CMAKE.replace('"srv/AddTwoInts.srv"', '"srv/Add  TwoInts.srv"'),
        CMAKE.replace("find_package(a", 'message("# no comment")\nfind_package(a'),
        CMAKE.replace("\nproject", " project"),
        CMAKE.replace("ament_package()", "ament_package("),
    ],
)  # fmt: skip
def test_what_means_something_else_to_cmake_stays_different(text: str) -> None:
    assert simple_text("CMakeLists.txt", text) != simple_text("CMakeLists.txt", CMAKE)


@pytest.mark.parametrize(
    "text",
    [
        CMAKE + "#[[ a comment\n of two lines ]]\n",
        CMAKE + "set(x [=[\n# text ]=])\n",
        CMAKE + 'set(x "two\nlines # of text")\n',
        CMAKE + 'set(x "a \\" # b")\n',
        CMAKE + 'set(x -D"a"  )\n',
        CMAKE + 'set(x "a""b")\n',
    ],
)
def test_what_is_more_than_plain_commands_is_left_alone(text: str) -> None:
    assert simple_text("CMakeLists.txt", text) == text


def test_quoted_texts_keep_their_spaces_and_signs() -> None:
    assert '"a  (b) # c"' in simple_text("CMakeLists.txt", 'message(  "a  (b) # c"   )  # d\n')


@pytest.mark.parametrize(
    ("text", "simple"),
    [
        ("# TODO\nint64 \t a # first\n\nint64 b\n---\nint64 sum", DEFINITION),
        ('string name "a # b"  \n', 'string name "a # b"  \n'),
    ],
)
def test_definitions_lose_comments_and_needless_spaces(text: str, simple: str) -> None:
    assert simple_text("srv/AddTwoInts.srv", text) == simple


@pytest.mark.parametrize(
    "text",
    [
        DEFINITION.replace("---", "--- "),
        DEFINITION.replace("---", "---# the answer"),
        DEFINITION.replace("---", " ---"),
        DEFINITION.replace("int64 b", " int64 b"),
        DEFINITION.replace("int64 b", "int64\u00a0b"),
        DEFINITION.replace("int64 b", "\u3000int64 b"),
    ],
)
def test_a_definition_that_rosidl_refuses_never_becomes_one_that_it_takes(text: str) -> None:
    """The student's own would not build; an equal one of somebody else's did, and was taken for it."""
    for one, takes in ((DEFINITION, True), (text, False), (simple_text("srv/AddTwoInts.srv", text), False)):
        try:
            parse_service_string("my_robot_interfaces", "AddTwoInts", one)
        except (InvalidSpecification, IndexError):
            assert not takes
        else:
            assert takes


@pytest.mark.parametrize(
    "text",
    [
        INTERFACE_PACKAGE_XML.replace("<version>", "<!-- ### BEGIN -->\n  <version>"),
        INTERFACE_PACKAGE_XML.replace("Ada", "Ben").replace("MIT", "Apache-2.0").replace("Mine", ""),
        INTERFACE_PACKAGE_XML.replace("  <license>MIT</license>\n", "").replace(
            "</export>", "</export><license>MIT</license>"
        ),
        INTERFACE_PACKAGE_XML.replace(">ament_cmake</buildtool", ">\n ament_cmake\n</buildtool"),
    ],
    ids=["comment", "people", "order", "spaces"],
)
def test_a_package_xml_that_says_the_same_becomes_the_same(text: str) -> None:
    assert simple_text("package.xml", text) == simple_text("package.xml", INTERFACE_PACKAGE_XML)


@pytest.mark.parametrize(
    "text",
    [
        INTERFACE_PACKAGE_XML.replace("<member_of_group>rosidl_interface_packages</member_of_group>", ""),
        INTERFACE_PACKAGE_XML.replace("<!--", "").replace("buildtool_depend>rosidl", "exec_depend>rosidl"),
        INTERFACE_PACKAGE_XML.replace('format="3"', 'format="2"'),
        INTERFACE_PACKAGE_XML.replace("0.0.0", "0.0.1"),
        INTERFACE_PACKAGE_XML.replace("<package ", "<package"),
    ],
)
def test_a_package_xml_that_says_something_else_stays_different(text: str) -> None:
    assert simple_text("package.xml", text) != simple_text("package.xml", INTERFACE_PACKAGE_XML)


def test_two_packages_that_differ_in_comments_have_one_key(tmp_path: Path) -> None:
    for name in "ab":
        interface_package(tmp_path / name / "my_robot_interfaces", comment=f"# {name}\n")
    one, other = (sources_of(tmp_path / name, packages_in(tmp_path / name)) for name in "ab")
    assert one != other
    assert simplified(one) == simplified(other)


@pytest.mark.parametrize(
    ("file", "text"),
    [("src/node.cpp", ""), ("CMakeLists.txt", 'f("rosidl_typesupport_cpp")'), ("helper.py", "")],
)
def test_a_package_with_more_in_it_is_none(tmp_path: Path, file: str, text: str) -> None:
    folder = interface_package(tmp_path / "my_robot_interfaces")
    assert all(package.holds_only_interfaces for package in packages_in(tmp_path))
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text(text)
    assert not any(package.holds_only_interfaces for package in packages_in(tmp_path))


@pytest.mark.parametrize("name", ["CMakeLists.txt", "srv/AddTwoInts.srv"])
def test_far_too_much_is_built_as_it_is(name: str) -> None:
    # To simplify half a megabyte of brackets took ten seconds, outside of any box and anew for each build.
    tree = SourceTree((Source("p"), Source(f"p/{name}", b"()\n" * 20_000)))
    assert simplified(tree) is tree
