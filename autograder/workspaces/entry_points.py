"""Entry points in a setup.py: their format, and what is wrong with an invalid entry point."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterator

FORM = re2.compile(r"\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*([\w.]+)\s*")
"""Matches an entry point: executable, module and function. Use it only for ASCII: re2 rejects lone surrogates."""


def console_scripts(tree: ast.AST) -> ast.List | None:
    """Return the list of ``console_scripts`` in the syntax tree of a setup.py; None if there is none."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                named = isinstance(key, ast.Constant) and key.value == "console_scripts"
                if named and isinstance(value, ast.List):
                    return value
    return None


def first_objection(tree: ast.AST) -> str:
    """Return what is wrong with the first invalid entry point in a setup.py; empty if all are valid."""
    listed = console_scripts(tree)
    return next((objection(text) for text in _texts(listed) if not is_entry_point(text)), "")


def _texts(listed: ast.List | None) -> Iterator[str]:
    for element in listed.elts if listed else ():
        if isinstance(element, ast.Constant) and isinstance(element.value, str):
            yield element.value


def is_entry_point(text: str) -> bool:
    """Return True if a text has the format of an entry point."""
    return text.isascii() and FORM.fullmatch(text) is not None


def objection(entry: object) -> str:
    """Return a sentence that says what is wrong with an invalid entry point, and what to write."""
    if isinstance(entry, str) and entry.count("=") > 1 and entry.count(":") > 1:
        return (
            f"Two entry points have run together: {entry!r}. A comma is missing between them: Python joins two strings "
            "with nothing between. Write a comma after each entry point, behind its closing quotation mark."
        )
    what = _what_is_wrong(entry) if isinstance(entry, str) else ""
    return f"{entry!r} is not an entry point. {what}Write: executable = package.module:function"


def _what_is_wrong(entry: str) -> str:
    """Return the mistake in an entry point, as a sentence with a space after it; empty if the mistake is unknown."""
    if len(entry.strip()) <= 1:
        return "It is a single letter: put the string into a list, in square brackets. "
    if "(" in entry:
        return "Leave out the parentheses: the function is named here and not called. "
    if "/" in entry:
        return "Write dots in the module in place of slashes, as in an import. "
    if "=" not in entry:
        return "The equals sign between the executable and the module is missing. "
    if ":" not in entry:
        return "The colon between the module and the function is missing. "
    return ""
