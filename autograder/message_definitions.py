"""What messages of a type are made of, as text: the form in which a recording carries it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import re2
from ament_index_python import PackageNotFoundError, get_package_share_directory

if TYPE_CHECKING:
    from collections.abc import Iterator

_LINE = "=" * 80
_FIELD = re2.compile(r"^\s*([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w")
"""A line of a definition: a type, perhaps bounded or an array, and a name."""


def definition(type_name: str) -> str:
    """The definition of a type such as ``"geometry_msgs/msg/Twist"``, followed by those of all types in it.

    Raises:
        LookupError: This environment has no such type.
    """
    found = {type_name: _text(type_name)}
    waiting = [type_name]
    while waiting:
        for inner in _types_in(found[owner := waiting.pop()], owner.partition("/")[0]):
            if inner not in found:
                found[inner] = _text(inner)
                waiting.append(inner)
    first, *others = found.items()
    return "\n".join([first[1], *(f"{_LINE}\nMSG: {_short(name)}\n{text}" for name, text in others)])


def _text(type_name: str) -> str:
    try:
        package, kind, name = type_name.split("/")
        return (Path(get_package_share_directory(package)) / kind / f"{name}.msg").read_text(encoding="utf-8")
    except (ValueError, PackageNotFoundError, OSError) as error:
        raise LookupError(f"there is no definition of {type_name} here") from error


def _types_in(text: str, package: str) -> Iterator[str]:
    """The types of fields that are messages themselves: their names begin with a capital, or name a package."""
    for line in text.splitlines():
        field = _FIELD.match(line)
        if field is None or not (field[1][0].isupper() or "/" in field[1]):
            continue
        owner, _, name = field[1].rpartition("/")
        yield f"{owner.removesuffix('/msg') or package}/msg/{name}"


def _short(type_name: str) -> str:
    package, _, name = type_name.split("/")
    return f"{package}/{name}"
