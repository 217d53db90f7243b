"""Python launch files: what actions do, and what they refuse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from launch import LaunchContext, LaunchDescription
from launch.actions import (
    AppendEnvironmentVariable,
    DeclareLaunchArgument,
    ExecuteProcess,
    GroupAction,
    LogInfo,
    OpaqueFunction,
    SetEnvironmentVariable,
    SetLaunchConfiguration,
)
from launch.conditions import IfCondition, UnlessCondition
from launch.screen import output_plan
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, TextSubstitution
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap
from launch_ros.parameter_descriptions import ParameterValue, evaluate_dictionary

from tests.cases import cases

if TYPE_CHECKING:
    from launch.action import LaunchDescriptionEntity


def visit(context: LaunchContext, *entities: LaunchDescriptionEntity) -> LaunchContext:
    for entity in entities:
        visit(context, *(entity.visit(context) or ()))
    return context


def commands(*entities: LaunchDescriptionEntity) -> list[list[str]]:
    """Visit entities and return the command lines of the processes that they start."""
    context = visit(LaunchContext(), *entities)
    return [list(process.plan.cmd) for process in context.to_start]


def node(**arguments: Any) -> Node:
    return Node(**({"executable": "talker"} | arguments))


def test_a_node_without_anything() -> None:
    assert commands(node(arguments=["-v"])) == [["talker", "-v", "--ros-args"]]


def test_the_ros_arguments_of_a_node() -> None:
    made = node(
        name="t", namespace="room", remappings=[("chatter", ["news", "/today"])], ros_arguments=["--x"]
    )
    rules = ["-r", "__node:=t", "-r", "__ns:=/room", "-r", "chatter:=news/today"]
    assert commands(made) == [["talker", "--ros-args", "--x", "--ros-args", *rules]]


def test_namespace_remapping_and_parameter_of_a_group_end_with_it() -> None:
    group = GroupAction(
        [PushRosNamespace("a"), SetRemap("x", "y"), SetParameter("p", 1), node(namespace="b")]
    )
    assert commands(group, node()) == [
        ["talker", "--ros-args", "-r", "__ns:=/a/b", "-p", "p:=1", "-r", "x:=y"],
        ["talker", "--ros-args"],
    ]


def test_parameters_go_through_a_file() -> None:
    context = visit(
        LaunchContext(), node(name="t", namespace="/room", parameters=[{"a": {"b": 1}, "c": "5"}])
    )
    path = context.to_start[0].plan.cmd[-1]
    with open(path, encoding="utf-8") as file:  # noqa: PTH123
        assert file.read() == "/room/t:\n  ros__parameters:\n    a.b: 1\n    c: '5'\n"
    assert context.temporary_files == [path]


def test_parameter_values_keep_or_find_their_types() -> None:
    context = LaunchContext(launch_configurations={"rate": "2", "text": "3"})
    given = {
        "plain": "5",
        "found": LaunchConfiguration("rate"),
        "kept": ParameterValue(LaunchConfiguration("text"), value_type=str),
        "list": [1, 2.5],
        "many": {"deep": {"er": True}},
    }
    assert evaluate_dictionary(context, given) == {
        "plain": "5",
        "found": 2,
        "kept": "3",
        "list": [1.0, 2.5],
        "many.deep.er": True,
    }


@pytest.mark.parametrize("value", [[1, "a"], None, object(), []])
def test_values_that_no_parameter_can_have(value: object) -> None:
    with pytest.raises(TypeError, match="'p'"):
        evaluate_dictionary(LaunchContext(), {"p": value})


@pytest.mark.parametrize(("arguments", "error"), cases(__file__, "what_a_node_does_not_take"))
def test_what_a_node_does_not_take(arguments: dict[str, Any], error: str) -> None:
    with pytest.raises(TypeError, match=error):
        node(**arguments)


def test_other_actions_refuse_unknown_arguments_too() -> None:
    with pytest.raises(TypeError, match=r"LogInfo\(\) got an unexpected keyword argument 'level'"):
        LogInfo(msg="x", level="debug")
    with pytest.raises(TypeError, match="unexpected keyword argument 'timeout'"):
        ExecuteProcess(cmd=["x"], timeout=3)


def test_names_of_the_full_launch_are_named_as_such() -> None:
    import launch.actions
    import launch_ros.actions

    for module, name in ((launch.actions, "OpaqueCoroutine"), (launch_ros.actions, "LifecycleNode")):
        with pytest.raises(ImportError, match=f"{name} needs the full launch"):
            getattr(module, name)
        with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
            module.Nothing  # noqa: B018


def test_a_wrong_node_name_is_an_error() -> None:
    with pytest.raises(ValueError, match="Invalid node name: 'my node'"):
        commands(node(name="my node"))


def test_a_description_holds_only_actions() -> None:
    with pytest.raises(TypeError, match="a LaunchDescription holds actions"):
        LaunchDescription(["talker"])
    with pytest.raises(TypeError, match="a LaunchDescription holds actions"):
        LaunchDescription([[node()]])


def test_conditions() -> None:
    def given(value: str) -> list[list[str]]:
        return commands(
            SetLaunchConfiguration("on", value),
            node(condition=IfCondition(LaunchConfiguration("on")), arguments=["if"]),
            node(condition=UnlessCondition(LaunchConfiguration("on")), arguments=["unless"]),
        )

    assert [words[1] for words in given("true")] == ["if"]
    assert [words[1] for words in given("0")] == ["unless"]


def test_arguments_take_what_was_given_before_their_default() -> None:
    declare = DeclareLaunchArgument("rate", default_value="1")
    assert visit(LaunchContext(), declare).launch_configurations == {"rate": "1"}
    assert (
        visit(LaunchContext(launch_configurations={"rate": "9"}), declare).launch_configurations["rate"]
        == "9"
    )


def test_choices_and_missing_arguments() -> None:
    with pytest.raises(RuntimeError, match=r'Argument "c" provided value "x" is not valid'):
        visit(LaunchContext(launch_configurations={"c": "x"}), DeclareLaunchArgument("c", choices=["a", "b"]))
    with pytest.raises(RuntimeError, match='Required launch argument "c" was not provided'):
        visit(LaunchContext(), DeclareLaunchArgument("c"))
    with pytest.raises(RuntimeError, match="not in provided choices"):
        DeclareLaunchArgument("c", choices=["a"], default_value="b")


def test_the_environment_of_a_group_ends_with_it() -> None:
    inside: dict[str, str] = {}
    context = LaunchContext(environment={"P": "a"})
    visit(
        context,
        GroupAction(
            [
                SetEnvironmentVariable("X", "1"),
                AppendEnvironmentVariable("P", "b", prepend=True),
                OpaqueFunction(function=lambda c: inside.update(c.environment)),
            ]
        ),
    )
    assert inside == {"P": "b:a", "X": "1"}
    assert context.environment == {"P": "a"}


def test_a_group_without_forwarding_knows_only_what_it_names() -> None:
    seen: dict[str, str] = {}
    group = GroupAction(
        [OpaqueFunction(function=lambda c: seen.update(c.launch_configurations))],
        forwarding=False,
        launch_configurations={"kept": LaunchConfiguration("outer")},
    )
    context = visit(LaunchContext(launch_configurations={"outer": "1"}), group)
    assert seen == {"kept": "1"}
    assert context.launch_configurations == {"outer": "1"}


def test_a_function_may_return_actions() -> None:
    def choose(context: LaunchContext, *, which: str) -> list[Node]:
        return [node(arguments=[which, LaunchConfiguration("rate").perform(context)])]

    made = OpaqueFunction(function=choose, kwargs={"which": "a"})
    assert commands(SetLaunchConfiguration("rate", "3"), made) == [["talker", "a", "3", "--ros-args"]]


def test_paths_are_joined_part_by_part() -> None:
    path = PathJoinSubstitution([TextSubstitution(text="/w"), ["a", "b"], "c.yaml"])
    assert path.perform(LaunchContext()) == "/w/ab/c.yaml"


@pytest.mark.parametrize(
    ("output", "stdout", "stderr"),
    [
        ("screen", {"screen"}, {"screen"}),
        ("log", {"log"}, {"log", "screen"}),
        ("both", {"log", "screen"}, {"log", "screen"}),
        ({"stdout": "screen"}, {"screen"}, set()),
        ({"both": ["log"], "stderr": {"screen"}}, {"log"}, {"log", "screen"}),
    ],
)
def test_where_the_output_of_a_process_goes(output: Any, stdout: set[str], stderr: set[str]) -> None:
    plan = output_plan("talker-1", output)
    assert plan.places == {"stdout": stdout, "stderr": stderr}


def test_files_of_a_process_of_its_own() -> None:
    assert output_plan("t-1", "own_log").files == {
        "stdout": ("t-1-stdout.log", "t-1.log"),
        "stderr": ("t-1-stderr.log", "t-1.log"),
    }


@pytest.mark.parametrize("output", ["scren", {"out": "screen"}, {"stdout": "paper"}])
def test_wrong_outputs_are_named(output: Any) -> None:
    with pytest.raises(ValueError, match="is not a valid"):
        output_plan("t-1", output)
