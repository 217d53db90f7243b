"""Finds ROS interfaces by name, converts messages to plain data, and computes type hashes.

A type hash stands for the definition of an interface in DDS discovery (REP-2016). The hash also depends on the name of
the package, so the same definition in two packages has two hashes.
"""

from __future__ import annotations

import array
import hashlib
import importlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import re2

if TYPE_CHECKING:
    from rclpy.node import Node


_SIDES = {"request": "rq{service}Request", "response": "rr{service}Reply"}
"""The names that rmw_fastrtps gives to the two DDS topics of a service. The keys are the parts of the service type, and
each topic announces the type hash of its part.
"""


class UnknownInterface(LookupError):
    """The interface is not installed in this Python environment."""


def interface(type_name: str) -> Any:
    """Return the class of an interface such as ``std_msgs/msg/String``.

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
    """Return the fields of a service type, in order: ``{"request": {name: type}, "response": {name: type}}``."""
    service = interface(type_name)
    sides = {"request": service.Request, "response": service.Response}
    return {side: dict(message.get_fields_and_field_types()) for side, message in sides.items()}


def to_data(message: Any) -> Any:
    """Return a message as data that JSON can contain: nested dicts, lists, numbers, text; bytes become lists."""
    if hasattr(message, "get_fields_and_field_types"):
        return {field: to_data(getattr(message, field)) for field in message.get_fields_and_field_types()}
    if isinstance(message, (bytes, bytearray)):
        return list(message)
    if isinstance(message, (list, tuple, array.array)) or hasattr(message, "tolist"):
        return [to_data(item) for item in message]
    return message


def filled(message: Any, fields: Mapping[str, Any]) -> Any:
    """Set fields of a message and return the message. Nested messages are given as mappings, also in lists.

    Raises:
        AttributeError: The message has no field with that name.
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
    """Return the class of the elements of a field such as ``sequence<rcl_interfaces/Parameter>``."""
    package, name = re2.findall(r"(\w+)/(\w+)", message.get_fields_and_field_types()[field])[0]
    return interface(f"{package}/msg/{name}")


def served_hashes(judge: Node, service: str) -> dict[str, str]:
    """Return the type hashes of a service's request and response, as the server announces them."""
    readers = judge.get_subscriptions_info_by_topic(_SIDES["request"].format(service=service), no_mangle=True)
    writers = judge.get_publishers_info_by_topic(_SIDES["response"].format(service=service), no_mangle=True)
    found = {"request": readers, "response": writers}
    return {
        side: str(info.topic_type_hash)
        for side, infos in found.items()
        for info in infos
        if info.node_name != judge.get_name()
    }


def expected_hashes(type_name: str, package: str) -> dict[str, str]:
    """Return the type hashes that a service type would have if another package defined it.

    Args:
        type_name: An installed service type, such as ``"my_robot_interfaces/srv/AddTwoInts"``.
        package: The name of the other package.

    Raises:
        LookupError: The type is not installed, or contains other interfaces.
    """
    home, kind, name = type_name.split("/")
    parts = _description(home, kind, name)["type_description_msg"]["referenced_type_descriptions"]
    hashes = {}
    for side, suffix in (("request", "_Request"), ("response", "_Response")):
        described = next(part for part in parts if part["type_name"] == f"{type_name}{suffix}")
        if any(field["type"]["nested_type_name"] for field in described["fields"]):
            raise LookupError(
                f"{type_name} contains other interfaces, so its type hash cannot be computed here"
            )
        moved = {**described, "type_name": f"{package}/{kind}/{name}{suffix}"}
        hashes[side] = type_hash({"type_description": moved, "referenced_type_descriptions": []})
    return hashes


def type_hash(description: dict[str, Any]) -> str:
    """Return the RIHS01 hash of a type description: the SHA-256 of its JSON without default values."""
    described = description["type_description"]
    fields = [{key: value for key, value in f.items() if key != "default_value"} for f in described["fields"]]
    bare = {**description, "type_description": {**described, "fields": fields}}
    return f"RIHS01_{hashlib.sha256(json.dumps(bare, separators=(', ', ': ')).encode()).hexdigest()}"


def _description(package: str, kind: str, name: str) -> Any:
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        file = Path(prefix, "share", package, kind, f"{name}.json")
        if file.is_file():
            return json.loads(file.read_text(encoding="utf-8"))
    raise LookupError(
        f"no description of {package}/{kind}/{name} in AMENT_PREFIX_PATH: is the package built?"
    )
