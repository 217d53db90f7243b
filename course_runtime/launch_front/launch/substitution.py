"""Substitutions: values that are known only when the launch runs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .launch_context import LaunchContext


class SubstitutionFailure(Exception):
    """A substitution has no value."""


class Substitution:
    """An object that `perform` turns into a text when the launch runs."""

    def describe(self) -> str:
        """Return a short form for `--print` and `--show-args`."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: There is no value.
        """
        raise NotImplementedError


class TextSubstitution(Substitution):
    """A plain text."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected Text object got '{type(text)}' instead.")
        self.text = text

    def describe(self) -> str:
        """Return the text in quotes."""
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:  # noqa: ARG002 (a text is always known)
        """Return the text."""
        return self.text


# The values that launch files may pass as a text: a text, a substitution, or a list of these to be joined.
SomeSubstitutionsType = str | Substitution | Iterable[str | Substitution]
SomeSubstitutionsType_types_tuple = (str, Substitution, Iterable)


def normalize(value: SomeSubstitutionsType) -> list[Substitution]:
    """Return a text, a substitution or a mixed list of these as a list of substitutions.

    Raises:
        TypeError: The value is something else.
    """
    if isinstance(value, str):
        return [TextSubstitution(text=value)]
    if isinstance(value, Substitution):
        return [value]
    if isinstance(value, Iterable):
        return [part for item in value for part in _item(item)]
    raise TypeError(
        f"expected a text, a substitution or a list of them, got {value!r} ({type(value).__name__})"
    )


def _item(value: object) -> list[Substitution]:
    if isinstance(value, str | Substitution):
        return normalize(value)
    raise TypeError(f"a list of texts and substitutions can not hold {value!r} ({type(value).__name__})")


def perform(context: LaunchContext, substitutions: Iterable[Substitution]) -> str:
    """Return the values of substitutions, joined."""
    return "".join(part.perform(context) for part in substitutions)


def describe(substitutions: Iterable[Substitution]) -> str:
    """Return the short forms of substitutions, as `'a' + LaunchConfig('b')`."""
    return " + ".join(part.describe() for part in substitutions)
