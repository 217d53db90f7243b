"""Messages from plain data; type hashes: as the generators compute them, and different for different fields."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import pytest

from autograder.judge.bench.ros_interfaces import (
    MisfitError,
    expected_hashes,
    filled,
    interface,
    to_data,
    type_hash,
)

pytestmark = pytest.mark.ros

TYPE = "my_robot_interfaces/srv/AddTwoInts"


def test_a_mapping_stands_for_a_message_also_in_a_list() -> None:
    request = interface("rcl_interfaces/srv/SetParameters").Request
    value = {"type": 4, "string_value": "Hi"}
    made = filled(request, {"parameters": [{"name": "text", "value": value}, {"name": "other"}]}, "/set")
    first, second = to_data(made)["parameters"]
    assert (first["name"], first["value"]["type"], first["value"]["string_value"]) == ("text", 4, "Hi")
    assert (second["name"], second["value"]["type"]) == ("other", 0)


@pytest.mark.parametrize(
    ("kind", "given", "made"),
    [
        ("geometry_msgs/msg/Point", {"x": 5, "y": -58}, {"x": 5.0, "y": -58.0, "z": 0.0}),
        ("std_msgs/msg/Float32", {"data": True}, "data is float32 and cannot hold True"),
        ("std_msgs/msg/Float32", {"data": 1e39}, "data is float32 and cannot hold 1e+39"),
        ("std_msgs/msg/Float64", {"data": "x"}, "data is float64 and cannot hold 'x'"),
        ("std_msgs/msg/Float64", {"data": 10**400}, "data is float64 and cannot hold 1000"),
        ("std_msgs/msg/Float64", {"data": [1.0]}, "data is float64 and cannot hold [1.0]"),
        ("std_msgs/msg/Int32", {"data": 2.5}, "data is int32 and cannot hold 2.5"),
        ("std_msgs/msg/Int32", {"data": 2**31}, "data is int32 and cannot hold 2147483648"),
        ("std_msgs/msg/UInt8", {"data": -1}, "data is uint8 and cannot hold -1"),
        ("std_msgs/msg/Bool", {"data": 1}, "data is bool and cannot hold 1"),
        ("std_msgs/msg/Byte", {"data": 1}, "data is byte and cannot hold 1"),
        ("std_msgs/msg/Byte", {"data": b"1"}, {"data": [49]}),
        ("std_msgs/msg/String", {"data": 1}, "data is string and cannot hold 1"),
        ("std_msgs/msg/Float64MultiArray", {"data": (1, 2.5)}, {"data": [1.0, 2.5]}),
        (
            "std_msgs/msg/Float64MultiArray",
            {"data": [1, "a"]},
            "is sequence<float64> and cannot hold [1, 'a']",
        ),
        ("std_msgs/msg/Float64MultiArray", {"data": 1}, "data is sequence<float64> and cannot hold 1"),
        ("std_msgs/msg/ByteMultiArray", {"data": "ab"}, "data is sequence<byte> and cannot hold 'ab'"),
        ("std_msgs/msg/UInt8MultiArray", {"data": b"ab"}, {"data": [97, 98]}),
        (
            "geometry_msgs/msg/PoseWithCovariance",
            {"covariance": range(36)},
            {"covariance": [*map(float, range(36))]},
        ),
        (
            "geometry_msgs/msg/PoseWithCovariance",
            {"covariance": [0] * 35},
            "covariance is float64[36] and cannot",
        ),
        (
            "geometry_msgs/msg/PoseWithCovariance",
            {"pose": {"position": {"x": ""}}},
            "field pose.position.x is",
        ),
        (
            "geometry_msgs/msg/PoseWithCovariance",
            {"pose": {"place": 1}},
            "no field is called pose.place; the fields",
        ),
        ("geometry_msgs/msg/PoseWithCovariance", {"pose": 5}, "pose is geometry_msgs/Pose and cannot hold 5"),
        ("geometry_msgs/msg/Polygon", {"points": [{"x": 1}, {"y": "2"}]}, "field points[1].y is float32"),
        (
            "geometry_msgs/msg/Polygon",
            {"points": {"x": 1}},
            "points is sequence<geometry_msgs/Point32> and cannot",
        ),
        (
            "rcl_interfaces/msg/ParameterDescriptor",
            {"integer_range": [{}, {}]},
            "Range, 1> and cannot hold [{}, {}]",
        ),
    ],
)
def test_a_message_is_filled_by_the_types_of_its_fields(
    kind: str, given: dict[str, Any], made: dict[str, Any] | str
) -> None:
    if isinstance(made, dict):
        data = to_data(filled(interface(kind), given, "/it"))
        assert {name: data[name] for name in made} == made
        assert [type(data[name]) for name in made] == [type(value) for value in made.values()]
        return
    with pytest.raises(MisfitError, match=f"^/it: .*{re.escape(made)}"):
        filled(interface(kind), given, "/it")


def test_arrays_and_their_numbers_become_plain() -> None:
    odometry, scan = (
        interface("nav_msgs/msg/Odometry")(),
        interface("sensor_msgs/msg/LaserScan")(ranges=[0.5]),
    )
    assert to_data(odometry)["pose"]["covariance"] == [0.0] * 36
    assert json.dumps(to_data(scan)["ranges"]) == "[0.5]"
    assert to_data(odometry.pose.covariance[0]) == 0.0


def description() -> Any:
    """What the build of the course's interfaces has written."""
    for prefix in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep):
        file = Path(prefix, "share", "my_robot_interfaces", "srv", "AddTwoInts.json")
        if file.is_file():
            return json.loads(file.read_text())
    pytest.skip("the course's interfaces are not built")


def test_the_hashes_are_those_of_the_generators() -> None:
    written = {entry["type_name"]: entry["hash_string"] for entry in description()["type_hashes"]}
    assert expected_hashes(TYPE, "my_robot_interfaces") == {
        "request": written[f"{TYPE}_Request"],
        "response": written[f"{TYPE}_Response"],
    }


def test_another_package_has_other_hashes() -> None:
    assert expected_hashes(TYPE, "arm_msgs") != expected_hashes(TYPE, "my_robot_interfaces")


@pytest.mark.parametrize(("key", "value"), [("name", "x"), ("type", {"type_id": 6})])
def test_another_field_has_another_hash(key: str, value: Any) -> None:
    parts = description()["type_description_msg"]["referenced_type_descriptions"]
    request = next(part for part in parts if part["type_name"] == f"{TYPE}_Request")
    whole = {"type_description": request, "referenced_type_descriptions": []}
    before = type_hash(whole)
    field = request["fields"][0]
    field[key] = {**field[key], **value} if isinstance(value, dict) else value
    assert type_hash(whole) != before


def test_a_type_that_is_not_installed_is_named() -> None:
    with pytest.raises(LookupError, match="Subtract"):
        expected_hashes("my_robot_interfaces/srv/Subtract", "arm_msgs")
