"""The cases of a test, where they are data: in the file beside it that has its name and ends in ``.toml``."""

from __future__ import annotations

import functools
import tomllib
from pathlib import Path
from typing import Any

import pytest


def cases(test: str, name: str) -> Any:
    """Return a value of the file of cases that belongs to a test; arrays are tuples.

    Args:
        test: The path of the test's own file.
        name: The key in the file.
    """
    return _with_tuples(_read(Path(test).with_suffix(".toml"))[name])


def named_cases(test: str, name: str) -> list[Any]:
    """Return the rows of a table as parameters that are called by their keys."""
    return [pytest.param(*row, id=key) for key, row in cases(test, name).items()]


@functools.cache
def _read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def _with_tuples(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _with_tuples(inner) for key, inner in value.items()}
    return tuple(map(_with_tuples, value)) if isinstance(value, list) else value
