"""Converts texts of a launch file to numbers and truth values."""

from __future__ import annotations

import typing
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .launch_context import LaunchContext

_SCALARS = (bool, int, float, str)


class InvalidConditionExpressionError(Exception):
    """A condition is neither true nor false."""


def truth(text: str) -> bool:
    """Read a truth value.

    Raises:
        InvalidConditionExpressionError: The text is not true, false, 1 or 0.
    """
    word = text.strip().lower()
    if word in ("true", "1"):
        return True
    if word in ("false", "0"):
        return False
    raise InvalidConditionExpressionError(f"'{text}' is not a truth value: it must be true, false, 1 or 0")


def value_of_text(text: str, value_type: Any = None) -> Any:
    """Return the value that a text stands for.

    Args:
        text: The text, in YAML.
        value_type: bool, int, float, str or a List of one of these; None for the type that YAML finds.

    Raises:
        ValueError: The text is not a valid value.
    """
    import yaml

    if value_type is str:
        return text
    if value_type is bool:
        return _checked(text, yaml.safe_load({"1": "true", "0": "false"}.get(text, text)), (bool,))
    if value_type in (int, float):
        return value_type(text)
    value = yaml.safe_load(text) if text else text
    if value_type is None:
        return _checked(text, value, _SCALARS)
    item_type = typing.get_args(value_type)[0]
    if not isinstance(value, list) or not all(isinstance(item, item_type) for item in value):
        raise ValueError(f"'{text}' is not a list of {item_type.__name__}")
    return value


def _checked(text: str, value: Any, allowed: tuple[type, ...]) -> Any:
    items = value if isinstance(value, list) else [value]
    if all(isinstance(item, allowed) for item in items) and len({type(item) for item in items}) <= 1:
        return value
    raise ValueError(f"'{text}' is not a value of type {' or '.join(kind.__name__ for kind in allowed)}")


def number(context: LaunchContext, value: Any) -> float:
    """Return a number that was given as such, as a text or as a substitution.

    Raises:
        ValueError: The text is not a number.
    """
    from .substitution import normalize, perform

    return float(value if isinstance(value, int | float) else perform(context, normalize(value)))


def flag(context: LaunchContext, value: Any) -> bool:
    """Return a truth value that was given as such, as a text or as a substitution."""
    from .substitution import normalize, perform

    return value if isinstance(value, bool) else truth(perform(context, normalize(value)))
