"""Messages from plain data; type hashes: as the generators compute them, and different for different fields."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from autograder.judge.bench.ros_interfaces import expected_hashes, filled, interface, to_data, type_hash

pytestmark = pytest.mark.ros

TYPE = "my_robot_interfaces/srv/AddTwoInts"


def test_a_mapping_stands_for_a_message_also_in_a_list() -> None:
    request = interface("rcl_interfaces/srv/SetParameters").Request()
    value = {"type": 4, "string_value": "Hi"}
    filled(request, {"parameters": [{"name": "text", "value": value}, {"name": "other"}]})
    first, second = to_data(request)["parameters"]
    assert (first["name"], first["value"]["type"], first["value"]["string_value"]) == ("text", 4, "Hi")
    assert (second["name"], second["value"]["type"]) == ("other", 0)


def test_a_misspelt_field_is_an_error() -> None:
    request = interface("rcl_interfaces/srv/SetParameters").Request()
    with pytest.raises(AttributeError):
        filled(request, {"parameter": []})
    with pytest.raises(AttributeError):
        filled(request, {"parameters": [{"nam": "text"}]})


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
