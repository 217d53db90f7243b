"""Messages from plain data."""

from __future__ import annotations

import pytest

from autograder.judge.bench.interfaces import filled, interface, to_data

pytestmark = pytest.mark.ros


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
