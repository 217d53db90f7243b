"""The tags about ROS of XML and YAML launch files."""

from __future__ import annotations

import typing
from typing import TYPE_CHECKING, Any

from launch.frontend.entity import Entity, FrontendError
from launch.frontend.tags import condition, expose_tag, name_and_value, optional, pairs, process_arguments
from launch.frontend.texts import expose_substitution, parse_command, parse_text, parse_value
from launch.typed import value_of_text

from .actions import Node, PushROSNamespace, SetParameter, SetRemap
from .parameter_descriptions import ParameterFile, ParameterValue
from .substitutions import ExecutableInPackage, FindPackagePrefix, FindPackageShare

if TYPE_CHECKING:
    from launch.action import Action

expose_substitution("find-pkg-prefix", FindPackagePrefix, 1, 1)
expose_substitution("find-pkg-share", FindPackageShare, 1, 1)
expose_substitution("exec-in-pkg", ExecutableInPackage, 2, 2)

_TYPES: dict[str, Any] = {
    "str": str,
    "bool": bool,
    "float": float,
    "int": int,
    "list_of_str": list[str],
    "list_of_bool": list[bool],
    "list_of_float": list[float],
    "list_of_int": list[int],
    "yaml": None,
}


@expose_tag("node")
def _node(entity: Entity) -> Action:
    arguments = process_arguments(entity)
    arguments |= optional(entity, package="pkg", name="name", namespace="namespace", exec_name="exec_name")
    for keyword, attribute in (("arguments", "args"), ("ros_arguments", "ros_args")):
        text = entity.text(attribute)
        if text is not None:
            arguments[keyword] = parse_command(text)
    return Node(
        executable=parse_text(entity.need("exec")),
        remappings=pairs(entity, "remap", "from", "to"),
        parameters=[_parameter(child) for child in entity.inside("param")],
        **arguments,
    )


def _parameter(entity: Entity) -> Any:
    """Return the parameters that a `param` tag of a node describes."""
    path = entity.text("from")
    if path is None:
        if entity.text("name") is None:
            raise FrontendError("param Entity should have name or from attribute")
        return _named_parameter(entity)
    if entity.text("name") is not None:
        raise FrontendError("name and from attributes are mutually exclusive")
    substitutions = parse_text(entity.text("allow_substs") or "false")
    entity.check_all_read()
    return ParameterFile(parse_text(path), allow_substs=substitutions)


def _named_parameter(entity: Entity) -> dict[Any, Any]:
    name = tuple(parse_text(entity.need("name")))
    type_name, value = entity.text("type"), entity.get("value")
    nested = entity.inside("param")
    entity.check_all_read()
    if (value is None) == (not nested) or (type_name is not None and nested):
        raise FrontendError("a param needs either a value or nested params, and nested ones have no type")
    if nested:
        inner: dict[Any, Any] = {}
        for child in nested:
            inner |= _named_parameter(child)
        return {name: inner}
    if type_name is not None and type_name not in _TYPES:
        raise FrontendError(f"Got invalid type identifier '{type_name}'")
    return {name: _typed(parse_value(value), _TYPES.get(type_name or "yaml"))}


def _typed(value: Any, value_type: Any) -> ParameterValue:
    """Return a value from XML, where everything is text, converted to the type that it seems to have."""
    if isinstance(value, str):
        value = value_of_text(value, value_type)
    elif isinstance(value, list) and all(isinstance(item, str) for item in value):
        item_type = typing.get_args(value_type)[0] if value_type else None
        value = [value_of_text(item, item_type) for item in value]
    return ParameterValue(value, value_type=value_type)


@expose_tag("push_ros_namespace", "push-ros-namespace")
def _push_namespace(entity: Entity) -> Action:
    return PushROSNamespace(parse_text(entity.need("namespace")), **condition(entity))


@expose_tag("set_remap")
def _set_remap(entity: Entity) -> Action:
    return SetRemap(parse_text(entity.need("from")), parse_text(entity.need("to")), **condition(entity))


@expose_tag("set_parameter")
def _set_parameter(entity: Entity) -> Action:
    name, value = name_and_value(entity)
    return SetParameter(name, value, **condition(entity))
