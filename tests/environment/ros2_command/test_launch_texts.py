"""Texts, values and tags of XML and YAML launch files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from launch.frontend.entity import FrontendError, from_xml, from_yaml
from launch.frontend.loader import load
from launch.frontend.texts import parse_command, parse_text
from launch.launch_context import LaunchContext
from launch.substitution import SubstitutionFailure, perform
from launch.typed import InvalidConditionExpressionError, truth, value_of_text
from launch_ros.names import check_namespace, check_node_name, inner_namespace

from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def context() -> LaunchContext:
    made = LaunchContext(
        environment={"ROBOT": "r2", "PATH": "/bin"}, current_launch_file="/w/launch/a.launch.xml"
    )
    made.launch_configurations.update(name="talker", rate="2.5", yes="true")
    return made


@pytest.mark.parametrize(
    ("text", "value"),
    cases(__file__, "substitutions_in_texts"),
)
def test_substitutions_in_texts(text: str, value: str, context: LaunchContext) -> None:
    assert perform(context, parse_text(text)) == value


@pytest.mark.parametrize(("text", "error"), cases(__file__, "wrong_texts"))
def test_wrong_texts(text: str, error: str) -> None:
    with pytest.raises(FrontendError, match=error):
        parse_text(text)


def test_what_has_no_value_is_named(context: LaunchContext) -> None:
    with pytest.raises(SubstitutionFailure, match="launch configuration 'nothing' does not exist"):
        perform(context, parse_text("$(var nothing)"))
    with pytest.raises(SubstitutionFailure, match="environment variable 'NOTHING' does not exist"):
        perform(context, parse_text("$(env NOTHING)"))


@pytest.mark.parametrize(("text", "words"), cases(__file__, "command_lines_are_split_at_spaces"))
def test_command_lines_are_split_at_spaces(text: str, words: tuple[str, ...], context: LaunchContext) -> None:
    assert [perform(context, word) for word in parse_command(text)] == list(words)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("5", None, 5),
        ("5.0", None, 5.0),
        ("true", None, True),
        ("hello", None, "hello"),
        ("[1, 2]", None, [1, 2]),
        ("5", str, "5"),
        ("5", float, 5.0),
        ("1", bool, True),
        ("[1, 2]", list[int], [1, 2]),
        ("[a]", list[str], ["a"]),
    ],
)
def test_values_of_texts(text: str, kind: Any, value: object) -> None:
    found = value_of_text(text, kind)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(("text", "kind"), [("x", int), ("[1, a]", None), ("maybe", bool), ("5", list[int])])
def test_values_that_do_not_fit(text: str, kind: Any) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 (the texts differ, the kind is what matters)
        value_of_text(text, kind)


def test_only_four_words_are_truth_values() -> None:
    assert [truth(word) for word in ("true", "True", "1", " false ", "0")] == [True, True, True, False, False]
    with pytest.raises(InvalidConditionExpressionError, match="must be true, false, 1 or 0"):
        truth("yes")


def test_both_formats_give_the_same_entities() -> None:
    xml = from_xml(
        '<launch><node pkg="p" exec="e"><remap from="a" to="b"/></node>'
        '<group scoped="false"><log message="m"/></group></launch>'
    )
    yaml = from_yaml(
        "launch:\n- node:\n    pkg: p\n    exec: e\n    remap:\n    - {from: a, to: b}\n"
        "- group:\n    scoped: 'false'\n    children:\n    - log: {message: m}\n"
    )
    assert xml == yaml


@pytest.mark.parametrize(("body", "error"), cases(__file__, "wrong_tags_are_named"))
def test_wrong_tags_are_named(body: str, error: str, tmp_path: Path) -> None:
    path = tmp_path / "a.launch.xml"
    path.write_text(f"<launch>{body}</launch>")
    with pytest.raises(FrontendError, match=error):
        load(str(path))


@pytest.mark.parametrize(("text", "error"), cases(__file__, "wrong_yaml_is_named"))
def test_wrong_yaml_is_named(text: str, error: str, tmp_path: Path) -> None:
    path = tmp_path / "a.launch.yaml"
    path.write_text(text)
    with pytest.raises(FrontendError, match=error):
        load(str(path))


@pytest.mark.parametrize(
    ("outer", "inner", "full"),
    [
        *cases(__file__, "namespaces"),
        (None, None, None),
        (None, "a", "/a"),
        ("/a", None, "/a"),
    ],
)
def test_namespaces(outer: str | None, inner: str | None, full: str | None) -> None:
    assert inner_namespace(outer, inner) == full


@pytest.mark.parametrize("name", ["1st", "my node", "a/b", ""])
def test_wrong_names(name: str) -> None:
    with pytest.raises(ValueError, match="Invalid node name"):
        check_node_name(name)
    with pytest.raises(ValueError, match="Invalid namespace"):
        check_namespace(f"/{name}/x" if name != "a/b" else "/a//b")
