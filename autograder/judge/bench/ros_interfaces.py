"""Finds ROS interfaces by name, converts messages to plain data, and computes type hashes.

A type hash stands for the definition of an interface in DDS discovery (REP-2016). The hash also depends on the name of
the package, so the same definition in two packages has two hashes.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import re2

from autograder.judge.bench.unreadable import names_are_read
from autograder.kit.in_words import shortened

if TYPE_CHECKING:
    from rclpy.node import Node


_SIDES = {"request": "rq{service}Request", "response": "rr{service}Reply"}
"""The names that rmw_fastrtps gives to the two DDS topics of a service. The keys are the parts of the service type, and
each topic announces the type hash of its part.
"""


_AS_DEFINED = {"float": "float32", "double": "float64", "boolean": "bool", "octet": "byte"}
"""The names of types in the definition of an interface, if the generated code has others."""
_FLOATS = ("float", "double")


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
    if isinstance(message, (list, tuple)):
        return [to_data(item) for item in message]
    # Numbers are in an array.array, or in a numpy.ndarray if the type gives their count.
    return message.tolist() if hasattr(message, "tolist") else message


class MisfitError(ValueError):
    """The exercise gives a message a field that the type does not have, or a value that the field cannot hold."""


def filled(kind: Any, fields: Mapping[str, Any], to: str, path: str = "") -> Any:
    """Return a message with these fields. Nested messages are given as mappings, also in lists.

    A whole number becomes a float if the field contains floats, because rclpy would send other bytes of the memory.

    Args:
        kind: The class of the message, such as the request of a service.
        fields: The values by the names of the fields. The other fields have their defaults.
        to: The name of the topic, service or action, for an error.
        path: The path of this message in the whole one, which ends with a dot; empty for the whole one.

    Raises:
        MisfitError: The message has no field with that name, or the field cannot hold the value.
    """
    # With this argument, the generated code checks each value: its type, its range and its length.
    message, types = kind(check_fields=True), kind.get_fields_and_field_types()
    for name, value in fields.items():
        if name not in types:
            raise MisfitError(f"{to}: no field is called {path}{name}; the fields are {', '.join(types)}")
        try:
            setattr(message, name, _fitting(types[name], value, to, f"{path}{name}"))
        except (AssertionError, TypeError, OverflowError):
            type_name = re2.sub(r"\b[a-z]+\b", lambda found: _AS_DEFINED.get(found[0], found[0]), types[name])
            raise MisfitError(
                f"{to}: field {path}{name} is {type_name} and cannot hold {shortened(repr(value))}"
            ) from None
    return message


def _fitting(type_name: str, value: Any, to: str, path: str) -> Any:
    """Return a value as the setter of a field of this type takes it, if it can."""
    # A sequence<double>, a sequence<double, 3> and a double[3] contain doubles.
    element = re2.match(r"(?:sequence<)?(\w[\w/]*)", type_name)[1]
    if element == type_name or isinstance(value, (str, Mapping)):
        if element == type_name and "/" in element and isinstance(value, Mapping):
            package, _, name = element.partition("/")
            return filled(interface(f"{package}/msg/{name}"), value, to, f"{path}.")
        return _as_float(value) if element in _FLOATS else value
    if "/" in element:
        return [_fitting(element, item, to, f"{path}[{index}]") for index, item in enumerate(value)]
    return [_as_float(item) for item in value] if element in _FLOATS else list(value)


def _as_float(value: Any) -> Any:
    """Return a whole number as a float; another value unchanged, also a bool."""
    return float(value) if type(value) is int else value


@names_are_read()
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
