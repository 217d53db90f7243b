"""The mutation operators: small functions from a program to the edits that make its mutants."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.authoring.mutants.operators import (
    conditions,
    names,
    numbers,
    outputs,
    places,
    reports,
    state,
    statements,
    values,
    waiting,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.authoring.mutants.code import Code, Edit

PYTHON: Sequence[Callable[[Code], Iterator[Edit]]] = (
    *names.OPERATORS,
    *numbers.OPERATORS,
    *values.OPERATORS,
    *statements.OPERATORS,
    *waiting.OPERATORS,
    *reports.OPERATORS,
    *conditions.OPERATORS,
    *places.OPERATORS,
    *state.OPERATORS,
    *outputs.OPERATORS,
)
