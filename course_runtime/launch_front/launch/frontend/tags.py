"""The tags of XML and YAML launch files."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..actions import (
    AppendEnvironmentVariable,
    DeclareLaunchArgument,
    ExecuteProcess,
    GroupAction,
    IncludeLaunchDescription,
    LogInfo,
    SetEnvironmentVariable,
    SetLaunchConfiguration,
    Shutdown,
    TimerAction,
    UnsetEnvironmentVariable,
    UnsetLaunchConfiguration,
)
from ..conditions import IfCondition, UnlessCondition
from ..unsupported import FULL
from .entity import Entity, FrontendError
from .texts import parse_command, parse_text

if TYPE_CHECKING:
    from ..action import Action

Maker = Callable[[Entity], "Action"]

_ELSEWHERE = (
    "composable_node",
    "load_composable_node",
    "node_container",
    "reset",
    "set_parameters_from_file",
    "set_use_sim_time",
)
_TAGS: dict[str, Maker] = {}


def expose_tag(*names: str) -> Callable[[Maker], Maker]:
    """Return a decorator that makes a function the reader of tags."""

    def expose(function: Maker) -> Maker:
        _TAGS.update(dict.fromkeys(names, function))
        return function

    return expose


def parse_entity(entity: Entity) -> Action:
    """Return the action that a tag describes.

    Raises:
        FrontendError: The tag is unknown, or contains something that is not allowed in it.
    """
    if entity.tag in _ELSEWHERE:
        raise FrontendError(f"`{entity.tag}` needs {FULL}: the course's own launch does not have it")
    if entity.tag not in _TAGS:
        raise FrontendError(f"Unrecognized entity of the type: {entity.tag}")
    action = _TAGS[entity.tag](entity)
    entity.check_all_read()
    return action


def condition(entity: Entity) -> dict[str, Any]:
    """Return the condition of a tag as a keyword argument; none if the tag has neither `if` nor `unless`."""
    holds, not_holds = entity.text("if"), entity.text("unless")
    if holds is not None and not_holds is not None:
        raise FrontendError("if and unless conditions can't be used simultaneously")
    if holds is not None:
        return {"condition": IfCondition(parse_text(holds))}
    return {} if not_holds is None else {"condition": UnlessCondition(parse_text(not_holds))}


def optional(entity: Entity, **attributes: str) -> dict[str, Any]:
    """Return the existing ones of these attributes as keyword arguments, as texts with substitutions."""
    given = {keyword: entity.text(attribute) for keyword, attribute in attributes.items()}
    return {keyword: parse_text(value) for keyword, value in given.items() if value is not None}


def name_and_value(entity: Entity) -> tuple[Any, Any]:
    """Return the `name` and the `value` of a tag."""
    return parse_text(entity.need("name")), parse_text(entity.need("value"))


def pairs(entity: Entity, tag: str, first: str, second: str) -> list[tuple[Any, Any]]:
    """Return two attributes of each tag with this name inside another tag, such as `from` and `to` of `remap`."""
    found = []
    for child in entity.inside(tag):
        found.append((parse_text(child.need(first)), parse_text(child.need(second))))
        child.check_all_read()
    return found


def truth_attribute(entity: Entity, name: str) -> dict[str, bool]:
    """Return an attribute that is true or false as a keyword argument; none if it does not exist."""
    value = entity.text(name)
    if value is None:
        return {}
    if value.lower() not in ("true", "false", "1", "0"):
        raise FrontendError(
            f"Attribute '{name}' of Entity '{entity.tag}' must be true or false, got '{value}'"
        )
    return {name: value.lower() in ("true", "1")}


def number_attribute(entity: Entity, keyword: str, kind: type[int] | type[float]) -> dict[str, Any]:
    """Return an attribute that is a number of at least 0 as a keyword argument; none if it does not exist."""
    value = entity.text(keyword)
    if value is None:
        return {}
    try:
        return {keyword: kind(value)}
    except ValueError:
        raise FrontendError(
            f"Attribute '{keyword}' of Entity '{entity.tag}' must be a number, got '{value}'"
        ) from None


def process_arguments(entity: Entity) -> dict[str, Any]:
    """Return the keyword arguments that a node shares with every process."""
    arguments: dict[str, Any] = condition(entity)
    arguments |= optional(entity, cwd="cwd", prefix="launch-prefix", output="output", respawn="respawn")
    arguments |= number_attribute(entity, "respawn_delay", float)
    arguments |= number_attribute(entity, "respawn_max_retries", int)
    for name in ("sigterm_timeout", "sigkill_timeout"):
        for value in number_attribute(entity, name, float).values():
            arguments[name] = str(value)
    for name in ("shell", "emulate_tty"):
        arguments |= truth_attribute(entity, name)
    on_exit = entity.text("on_exit")
    if on_exit not in (None, "shutdown"):
        raise FrontendError(f"Attribute on_exit of Entity node expected to be shutdown but got `{on_exit}`")
    if on_exit:
        arguments["on_exit"] = [Shutdown()]
    env = pairs(entity, "env", "name", "value")
    if env:
        arguments["additional_env"] = {tuple(name): value for name, value in env}
    return arguments


@expose_tag("arg")
def _arg(entity: Entity) -> Action:
    choices = [child.need("value") for child in entity.inside("choice")]
    description = entity.text("description")
    return DeclareLaunchArgument(
        entity.need("name"),
        description=description,
        choices=choices or None,
        **optional(entity, default_value="default"),
        **condition(entity),
    )


@expose_tag("let")
def _let(entity: Entity) -> Action:
    return SetLaunchConfiguration(*name_and_value(entity), **condition(entity))


@expose_tag("unset")
def _unset(entity: Entity) -> Action:
    return UnsetLaunchConfiguration(parse_text(entity.need("name")), **condition(entity))


@expose_tag("set_env")
def _set_env(entity: Entity) -> Action:
    return SetEnvironmentVariable(*name_and_value(entity), **condition(entity))


@expose_tag("unset_env")
def _unset_env(entity: Entity) -> Action:
    return UnsetEnvironmentVariable(parse_text(entity.need("name")), **condition(entity))


@expose_tag("append_env")
def _append_env(entity: Entity) -> Action:
    name, value = name_and_value(entity)
    more = optional(entity, prepend="prepend", separator="separator") | condition(entity)
    return AppendEnvironmentVariable(name, value, **more)


@expose_tag("log")
def _log(entity: Entity) -> Action:
    return LogInfo(msg=parse_text(entity.need("message")), **condition(entity))


@expose_tag("shutdown")
def _shutdown(entity: Entity) -> Action:
    return Shutdown(reason=entity.text("reason") or "reason not given", **condition(entity))


@expose_tag("include")
def _include(entity: Entity) -> Action:
    return IncludeLaunchDescription(
        parse_text(entity.need("file")),
        launch_arguments=pairs(entity, "arg", "name", "value"),
        **condition(entity),
    )


@expose_tag("group")
def _group(entity: Entity) -> Action:
    kept: Any = {tuple(name): value for name, value in pairs(entity, "keep", "name", "value")}
    return GroupAction(
        [parse_entity(child) for child in entity.all_inside() if child.tag != "keep"],
        launch_configurations=kept or None,
        **truth_attribute(entity, "scoped"),
        **truth_attribute(entity, "forwarding"),
        **condition(entity),
    )


@expose_tag("timer")
def _timer(entity: Entity) -> Action:
    return TimerAction(
        period=parse_text(entity.need("period")),
        actions=[parse_entity(child) for child in entity.all_inside()],
        **optional(entity, cancel_on_shutdown="cancel_on_shutdown"),
        **condition(entity),
    )


@expose_tag("executable")
def _executable(entity: Entity) -> Action:
    return ExecuteProcess(
        cmd=parse_command(entity.need("cmd")), **optional(entity, name="name"), **process_arguments(entity)
    )
