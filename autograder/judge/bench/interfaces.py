"""ROS interfaces by name, and messages as plain data."""

from __future__ import annotations

import array
import importlib
from collections.abc import Mapping
from typing import Any

import re2


class UnknownInterface(LookupError):
    """No such interface is installed for this Python."""


def interface(type_name: str) -> Any:
    """The class of an interface such as ``std_msgs/msg/String``.

    Raises:
        UnknownInterface: The package is not installed or has no such interface.
    """
    try:
        package, kind, name = type_name.split("/")
        return getattr(importlib.import_module(f"{package}.{kind}"), name)
    except (ValueError, ImportError, AttributeError) as error:
        raise UnknownInterface(
            f"no interface {type_name!r} in this environment: is its package built?"
        ) from error


def service_fields(type_name: str) -> dict[str, dict[str, str]]:
    """The fields of a service type in their order: ``{"request": {name: type}, "response": {name: type}}``."""
    service = interface(type_name)
    sides = {"request": service.Request, "response": service.Response}
    return {side: dict(message.get_fields_and_field_types()) for side, message in sides.items()}


def to_data(message: Any) -> Any:
    """A message as JSON-able data: nested dicts, lists, numbers, text; bytes as a list of numbers."""
    if hasattr(message, "get_fields_and_field_types"):
        return {field: to_data(getattr(message, field)) for field in message.get_fields_and_field_types()}
    if isinstance(message, (bytes, bytearray)):
        return list(message)
    if isinstance(message, (list, tuple, array.array)) or hasattr(message, "tolist"):
        return [to_data(item) for item in message]
    return message


def filled(message: Any, fields: Mapping[str, Any]) -> Any:
    """The message with these fields set; a mapping stands for a message, also in a list.

    Raises:
        AttributeError: It has no field of that name.
    """
    for name, value in fields.items():
        present = getattr(message, name)
        if isinstance(value, Mapping):
            filled(present, value)
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            element = _element_type(message, name)
            setattr(message, name, [filled(element(), inner) for inner in value])
        else:
            setattr(message, name, value)
    return message


def _element_type(message: Any, field: str) -> Any:
    """The class of the messages in a field, such as ``sequence<rcl_interfaces/Parameter>``."""
    package, name = re2.findall(r"(\w+)/(\w+)", message.get_fields_and_field_types()[field])[0]
    return interface(f"{package}/msg/{name}")
