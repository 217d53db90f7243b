"""Places: another field, side or element than the right one."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.authoring.mutants.code import Code, Edit

_AXES = ("x", "y", "z")
_OTHERS = {
    "left": ("right",),
    "right": ("left",),
    "linear": ("angular",),
    "angular": ("linear",),
    "first": ("last",),
    "last": ("first",),
    "width": ("height",),
    "height": ("width",),
    **{axis: tuple(other for other in _AXES if other != axis) for axis in _AXES},
}
"""Fields and sides that are taken for each other."""
_VELOCITIES = {".linear.x": ".angular.z", ".angular.z": ".linear.x"}
"""The two numbers of a Twist that a robot on wheels obeys."""
_OF_ALL = ("min({0})", "max({0})", "sum({0})/len({0})", "min({0}[:3])", "min([*{0}[-3:], *{0}[:4]])")
"""Values of a whole list instead of one element."""


def other_field(code: Code) -> Iterator[Edit]:
    """Another field of the same object: the other side or axis, or one that the program uses elsewhere."""
    known: dict[str, set[str]] = {}
    for attribute in _read(code, ast.walk(code.tree)):
        known.setdefault(code.source(attribute.value), set()).add(attribute.attr)
    for attribute in code.all(ast.Attribute):
        if _is_called(code, attribute):
            continue
        others = set(_OTHERS.get(attribute.attr, ()))
        if isinstance(attribute.ctx, ast.Load) and code.source(attribute.value) != "self":
            others |= known.get(code.source(attribute.value), set())
        for other in sorted(others - {attribute.attr}):
            yield code.tail_replaced(attribute, attribute.attr, other, f"{other} for {attribute.attr}")
        for path, other in _VELOCITIES.items():
            source = code.source(attribute)
            if source.endswith(path):
                yield code.replaced(attribute, source.removesuffix(path) + other, f"{other} for {path}")
    for call in code.all(ast.Call):
        for keyword in call.keywords:
            name = keyword.arg or ""
            for other in sorted({*_OTHERS.get(name, ()), *_keywords_of(code, call)} - {name}) if name else ():
                yield code.head_replaced(keyword, name, other)


def _read(code: Code, nodes: Iterator[ast.AST]) -> Iterator[ast.Attribute]:
    for node in nodes:
        if not isinstance(node, ast.Attribute) or _is_called(code, node):
            continue
        if isinstance(node.ctx, ast.Load) and isinstance(node.value, ast.Name):
            yield node


def _is_called(code: Code, attribute: ast.Attribute) -> bool:
    parent = code.parents.get(attribute)
    return isinstance(parent, ast.Call) and parent.func is attribute


def _keywords_of(code: Code, call: ast.Call) -> set[str]:
    """Return the keywords with which the program calls the same thing elsewhere."""
    name = code.source(call.func)
    return {
        str(keyword.arg)
        for other in code.all(ast.Call)
        if code.source(other.func) == name
        for keyword in other.keywords
        if keyword.arg
    }


def other_element(code: Code) -> Iterator[Edit]:
    """Another element of a list: the next, the last, one at a side; or a value of all of them."""
    for subscript in code.all(ast.Subscript):
        place = subscript.slice
        if not isinstance(subscript.ctx, ast.Load) or not isinstance(place, ast.Constant):
            continue
        if isinstance(place.value, int):
            whole = code.source(subscript.value)
            others = [str(place.value + 1), "-1" if place.value >= 0 else "0"]
            others += [f"len({whole}) // 4", f"len({whole}) // 2", f"3 * len({whole}) // 4"]
            for other in others:
                yield code.replaced(subscript, f"{whole}[{other}]", f"index {other.replace(whole, '')}")
            for form in _OF_ALL:
                yield code.replaced(subscript, form.format(whole), form)


OPERATORS = (other_field, other_element)
