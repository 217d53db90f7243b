"""What a node answers about its parameters, as it is compared with the solution.

A subject may serve these services itself, and then answers whatever it likes. An answer that no service of rclpy gives
is noted in words, so that it is a difference from the solution.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.evidence import Event

SET = ("set_parameters", "rcl_interfaces/srv/SetParameters")
DESCRIBE = ("describe_parameters", "rcl_interfaces/srv/DescribeParameters")
DESCRIBED = ("type", "ranges")
TYPES = {1: "bool", 2: "integer", 3: "double", 4: "string"}
"""The types of parameters (rcl_interfaces/msg/ParameterType.msg)."""
NOT_DECLARED = [0, []]
"""What is noted of a parameter that the node does not have."""


def described(events: Sequence[Event]) -> list[Any]:
    """Return the type of a parameter and its ranges, or what is odd about the answer, in words."""
    descriptors = _last(events, DESCRIBE, "descriptors")
    # A node answers with an empty list if one of the parameters is not declared.
    if not descriptors:
        return NOT_DECLARED
    if len(descriptors) > 1:
        return [f"{counted(len(descriptors), 'description')} of one parameter"]
    (one,) = descriptors
    ranges = (*one["floating_point_range"], *one["integer_range"])
    return [one["type"], [[each["from_value"], each["to_value"]] for each in ranges]]


def received(events: Sequence[Event]) -> list[Any]:
    """Return whether a new value was taken, and whether a reason came; or what is odd about the answer, in words."""
    results = _last(events, SET, "results")
    if len(results) != 1:
        return [f"{counted(len(results), 'result')} for one value"]
    # The words of a refusal are the student's own, so only the presence of a reason is compared.
    return [results[0]["successful"], bool(results[0]["reason"])]


def _last(events: Sequence[Event], service: tuple[str, str], field: str) -> Sequence[Mapping[str, Any]]:
    """Return a field of the last answer of a service, whichever node has sent it; empty if there is no answer."""
    answers = [e for e in events if e.kind == "answered" and e.name.endswith(f"/{service[0]}")]
    return answers[-1].data["fields"][field] if answers else ()


def parameter_in_words(noted: Sequence[Any]) -> str:
    """Return in words a parameter's noted type and ranges, or how a new value was received."""
    first = noted[0]
    if isinstance(first, str):
        return first
    if isinstance(first, bool):
        return "taken" if first else f"refused with{'' if noted[1] else 'out'} a reason"
    if first not in TYPES:
        return "not declared"
    ranges = " and ".join(f"from {low:g} to {high:g}" for low, high in noted[1]) or "without a range"
    return f"{TYPES[first]} {ranges}"


def parameter_value(value: float | str | bool) -> dict[str, Any]:
    """Return the fields of a rcl_interfaces/msg/ParameterValue.

    Raises:
        ValueError: The value is neither a number nor a text nor a truth value.
    """
    for number, python in ((1, bool), (2, int), (3, float), (4, str)):
        if isinstance(value, python):
            return {"type": number, f"{TYPES[number]}_value": value}
    raise ValueError(f"{value!r}, which is neither a number nor a text nor a truth value")
