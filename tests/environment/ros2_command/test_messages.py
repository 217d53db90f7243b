"""From YAML to a message and back, in the form of ros2cli."""

from __future__ import annotations

import pytest

pytest.importorskip("geometry_msgs")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PolygonStamped, PoseStamped, PoseWithCovariance
from my_robot_interfaces.action import Fibonacci
from std_msgs.msg import Bool, Float64, Int8MultiArray, String

from course_runtime.ros2_command.messages import (
    Shortening,
    fill,
    parse_values,
    to_csv,
    to_yaml,
)


def test_a_text_as_yaml() -> None:
    assert to_yaml(String(data="Hello, world! 3")) == "data: Hello, world! 3\n"


def test_nested_messages_keep_the_order_of_their_fields() -> None:
    message = PoseStamped()
    message.header.frame_id = "map"
    message.pose.position.x = 1.5
    assert to_yaml(message) == (
        "header:\n  stamp:\n    sec: 0\n    nanosec: 0\n  frame_id: map\n"
        "pose:\n  position:\n    x: 1.5\n    y: 0.0\n    z: 0.0\n"
        "  orientation:\n    x: 0.0\n    y: 0.0\n    z: 0.0\n    w: 1.0\n"
    )


def test_a_sequence_as_yaml() -> None:
    assert to_yaml(Fibonacci.Result(sequence=[0, 1, 1])) == "sequence:\n- 0\n- 1\n- 1\n"
    assert to_yaml(Fibonacci.Result(sequence=[0, 1, 1]), flow_style=True) == "{sequence: [0, 1, 1]}\n"


def test_long_values_are_cut() -> None:
    assert to_yaml(String(data="abcdef"), Shortening(3)) == "data: abc...\n"
    assert to_yaml(Fibonacci.Result(sequence=[5, 6, 7]), Shortening(2)) == "sequence:\n- 5\n- 6\n- '...'\n"


def test_arrays_and_strings_can_be_left_out() -> None:
    assert to_yaml(Fibonacci.Result(sequence=[5, 6]), Shortening(no_arrays=True)) == (
        "sequence: '<sequence type: int32, length: 2>'\n"
    )
    assert "covariance: '<array type: double[36]>'" in to_yaml(
        PoseWithCovariance(), Shortening(no_arrays=True)
    )
    assert to_yaml(String(data="abc"), Shortening(no_strings=True)) == "data: '<string length: <3>>'\n"


def test_csv_has_all_values_in_order() -> None:
    assert to_csv(Fibonacci.Result(sequence=[5, 6])) == "5,6"
    assert to_csv(PoseStamped()) == "0,0,,0.0,0.0,0.0,0.0,0.0,0.0,1.0"


def test_values_become_the_types_of_their_fields() -> None:
    number, text, truth = Float64(), String(), Bool()
    fill(number, {"data": 2})
    fill(text, {"data": 5})
    fill(truth, {"data": True})
    assert (repr(number.data), text.data, truth.data) == ("2.0", "5", True)


def test_numeric_arrays_and_arrays_of_messages() -> None:
    array, polygon = Int8MultiArray(), PolygonStamped()
    fill(array, {"data": [1, -2]})
    fill(polygon, {"polygon": {"points": [{"x": 1.0}, {"y": 2.0}]}})
    assert list(array.data) == [1, -2]
    assert [(p.x, p.y) for p in polygon.polygon.points] == [(1.0, 0.0), (0.0, 2.0)]


def test_now_and_auto_are_set_at_each_publishing() -> None:
    message = PoseStamped()
    setters = fill(message, {"header": "auto"})
    assert len(setters) == 1
    setters[0](Time(sec=7))
    assert message.header.stamp.sec == 7


def test_a_misspelt_field_is_named() -> None:
    with pytest.raises(AttributeError, match="'String' object has no attribute 'dta'"):
        fill(String(), {"dta": "x"})


def test_a_value_that_does_not_fit_is_an_error() -> None:
    with pytest.raises(ValueError, match="could not convert"):
        fill(Float64(), {"data": "fast"})


@pytest.mark.parametrize("text", ["hello", "[1, 2]", "{a: 1", "5"])
def test_values_must_be_a_dictionary(text: str) -> None:
    with pytest.raises(RuntimeError, match="YAML"):
        parse_values(text)
