"""The steps of a judge that compares a node with the solution, and the services that it serves meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random  # noqa: TC003  (an alias of types needs it)
from typing import TYPE_CHECKING, Any

from autograder.kit.recipes.relay import To

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping, Sequence

TYPES = {1: "bool", 2: "integer", 3: "double", 4: "string"}
"""The types of parameters (rcl_interfaces/msg/ParameterType.msg)."""


@dataclass(frozen=True)
class Serves:
    """A service of the judge that the subject calls.

    Attributes:
        answer: Draws the fields of an answer.
        late: The requests, counted from 1, that are answered late, with the delay in seconds of the subject's time.
        never: The requests that are never answered.
    """

    answer: Callable[[Random], Mapping[str, Any]]
    late: Mapping[int, float] = field(default_factory=dict)
    never: Container[int] = ()


@dataclass(frozen=True)
class Sets:
    """A step in which the judge sets a parameter of the subject; the subject takes the value or refuses it.

    Attributes:
        parameter: The name of the parameter.
        value: The new value: a number, a text or a truth value.
        node: The full name of the node; by default the subject's first node.
    """

    parameter: str
    value: float | str | bool
    node: str = ""

    @property
    def name(self) -> str:
        """The parameter, with its node if the author named one."""
        return f"{self.node}.{self.parameter}" if self.node else self.parameter


Step = To | Sets | float
"""A step of the judge: an input, a new value of a parameter, or a time to let pass, in seconds."""


def parameter_in_words(noted: Sequence[Any]) -> str:
    """Return in words a parameter's noted type and ranges, or how a new value was received."""
    first, second = noted
    if isinstance(first, bool):
        return "taken" if first else f"refused with{'' if second else 'out'} a reason"
    if first not in TYPES:
        return "not declared"
    ranges = " and ".join(f"from {low:g} to {high:g}" for low, high in second) or "without a range"
    return f"{TYPES[first]} {ranges}"


def parameter_value(value: float | str | bool) -> dict[str, Any]:
    """Return the fields of a rcl_interfaces/msg/ParameterValue."""
    kind = next(
        number for number, python in ((1, bool), (2, int), (3, float), (4, str)) if isinstance(value, python)
    )
    return {"type": kind, f"{TYPES[kind]}_value": value}
