"""Converts YAML to the fields of a message, and a message to YAML or CSV, in the form of ros2cli."""

from __future__ import annotations

import functools
import importlib
import re  # noqa: TID251  (not what a student handed in)
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

# Generated message classes have no common base class with types.
Message = Any
StampSetter = Callable[[Any], None]

_NESTED = re.compile(r"^sequence<(?P<item>[^,]+)(?:, (?P<bound>\d+))?>$|^(?P<fixed>.+)\[(?P<size>\d+)\]$")


@dataclass(frozen=True)
class Shortening:
    """The limits with which values are shortened.

    Attributes:
        length: The maximum number of elements or characters of a value; None for no limit.
        no_arrays: True to show the type and length of arrays instead of their elements.
        no_strings: True to show the length of strings instead of their text.
    """

    length: int | None = None
    no_arrays: bool = False
    no_strings: bool = False


WHOLE = Shortening()


def parse_values(text: str | bytes) -> Mapping[str, Any]:
    """Read the values that were given on the command line.

    Raises:
        RuntimeError: The text is not a dictionary in YAML.
    """
    import yaml

    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise RuntimeError(f"The passed value is not YAML: {error}") from error
    if not isinstance(values, dict):
        raise RuntimeError("The passed value needs to be a dictionary in YAML format")
    return values


def fill(message: Message, values: Mapping[str, Any]) -> list[StampSetter]:
    """Set fields of a message from plain values, converting a value to its field's type.

    Returns:
        A function for each field that was given as `now` (a Time) or `auto` (a Header). Call it with the current time
        before each publishing.

    Raises:
        AttributeError: The message does not have a field with a given name.
        TypeError, ValueError: A value does not fit its field.
    """
    if not isinstance(values, Mapping):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    setters: list[StampSetter] = []
    types = dict(zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True))
    for name, given in values.items():
        field = getattr(message, name)
        kind = f"{type(field).__module__}.{type(field).__name__}"
        if kind == "std_msgs.msg._header.Header" and given == "auto":
            setters.append(functools.partial(setattr, field, "stamp"))
        elif kind == "builtin_interfaces.msg._time.Time" and given == "now":
            setters.append(functools.partial(setattr, message, name))
        else:
            setattr(message, name, _converted(field, types[name], given, setters))
    return setters


def _converted(field: Any, slot_type: Any, given: Any, setters: list[StampSetter]) -> Any:
    item_type = getattr(slot_type, "value_type", None)
    if item_type is not None and hasattr(item_type, "namespaced_name"):
        element = getattr(importlib.import_module(".".join(item_type.namespaces)), item_type.name)
        elements = [element() for _ in given]
        for message, values in zip(elements, given, strict=True):
            setters.extend(fill(message, values))
        return elements
    if hasattr(field, "typecode"):
        return type(field)(field.typecode, given)
    if hasattr(field, "dtype"):
        import numpy

        return numpy.array(given, dtype=field.dtype)
    if hasattr(field, "SLOT_TYPES"):
        message = type(field)()
        setters.extend(fill(message, given))
        return message
    return given if type(given) is type(field) else type(field)(given)


def _abbreviation(declared: str, value: Any) -> str | None:
    """Return the short text for an array if arrays are not shown; None for any other value."""
    match = _NESTED.match(declared)
    if match is None:
        return None
    if match["fixed"]:
        return f"<array type: {match['fixed']}[{match['size']}]>"
    bound = f"[{match['bound']}]" if match["bound"] else ""
    return f"<sequence type: {match['item']}{bound}, length: {len(value)}>"


def plain(value: Any, shorten: Shortening = WHOLE) -> Any:
    """Return a message, or a value in it, as dictionaries, lists, strings and numbers."""
    if hasattr(value, "get_fields_and_field_types"):
        return {
            name: (shorten.no_arrays and _abbreviation(declared, getattr(value, name)))
            or plain(getattr(value, name), shorten)
            for name, declared in value.get_fields_and_field_types().items()
        }
    if isinstance(value, bytes):
        value = "".join(map(chr, value))
        return f"{value[: shorten.length]}..." if _too_long(value, shorten) else value
    if isinstance(value, str):
        if shorten.no_strings:
            return f"<string length: <{len(value)}>>"
        return f"{value[: shorten.length]}..." if _too_long(value, shorten) else value
    if hasattr(value, "dtype") and not hasattr(value, "__len__"):
        return value.item()
    if hasattr(value, "__len__"):
        shown = [plain(item, shorten) for item in value[: shorten.length]]
        return [*shown, "..."] if _too_long(value, shorten) else shown
    return value


def _too_long(value: Any, shorten: Shortening) -> bool:
    return shorten.length is not None and len(value) > shorten.length


def to_yaml(message: Message, shorten: Shortening = WHOLE, *, flow_style: bool = False) -> str:
    """Return a message as YAML, ending with a line break."""
    import yaml

    return str(
        yaml.dump(
            plain(message, shorten),
            allow_unicode=True,
            sort_keys=False,
            width=sys.maxsize,
            default_flow_style=flow_style,
        )
    )


def to_csv(message: Message, shorten: Shortening = WHOLE) -> str:
    """Return all values of a message, separated by commas."""
    return ",".join(_leaves(plain(message, shorten)))


def _leaves(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [leaf for item in value.values() for leaf in _leaves(item)]
    if isinstance(value, list):
        return [leaf for item in value for leaf in _leaves(item)]
    return [str(value)]
