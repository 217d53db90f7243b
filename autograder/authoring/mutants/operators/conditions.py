"""Conditions: turned round, looking at one thing of two, holding for ever, one step late."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

from autograder.authoring.mutants.code import SIGNS, Code, Edit, called

if TYPE_CHECKING:
    from collections.abc import Iterator

_TURNED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "==": "!=", "!=": "=="}


def turned(code: Code) -> Iterator[Edit]:
    """A comparison that is the other way round."""
    for _, left, sign, right in code.comparisons():
        if sign in _TURNED:
            yield code.sign_replaced(left, right, sign, _TURNED[sign], "turned")


def operand_left_out(code: Code) -> Iterator[Edit]:
    """One of two conditions that is not looked at."""
    for operation in code.all(ast.BoolOp):
        word = f" {SIGNS[type(operation.op)]} "
        for value in operation.values:
            rest = [code.source(one) for one in operation.values if one is not value]
            yield code.replaced(operation, f"({word.join(rest)})")


def bound(code: Code) -> Iterator[Edit]:
    """One bound of two, the lower bound for the upper one, or what is beyond the bounds refused."""
    for call in code.calls("min", "max"):
        name = called(call)
        if len(call.args) != 2:
            continue
        for place, value in enumerate(call.args):
            yield code.replaced(call, code.source(value), f"left out {name} {1 - place}")
        other = "max" if name == "min" else "min"
        yield code.head_replaced(call, name, other, f"{other} for {name}")
        inner: Any = next((one for one in call.args if called(one) == other), None)
        if inner is not None and len(inner.args) == 2:
            low = next(code.source(one) for one in call.args if one is not inner)
            high, value = (code.source(one) for one in inner.args)
            if name == "min":
                low, high = high, low
            yield code.replaced(call, f"({value} if {low} <= {value} <= {high} else 0.0)", "zero beyond")
            yield code.replaced(call, f"({low} if {value} < 0 else {high})", "always a bound")


def remembered(code: Code) -> Iterator[Edit]:
    """A condition that holds for ever once it holds, never again once it does not, or that is one call late."""
    for node in code.all(ast.If, ast.IfExp):
        test = code.source(node.test)
        if "__name__" in test or code.function_of(node) is None:
            continue
        name = f"_at_{code.mark(node)}"
        kept = f"{code.own_values(node)}.setdefault('{name}', [{{}}])"
        for kind, first, word in (("once true", "False", "or"), ("once false", "True", "and")):
            box = kept.format(first)
            yield code.replaced(
                node.test, f"({box}.append({box}[-1] {word} bool({test})) or {box}[-1])", kind
            )
        box = kept.format("False")
        yield code.replaced(node.test, f"({box}.append(bool({test})) or {box}[-2])", "one call late")


def one_side(code: Code) -> Iterator[Edit]:
    """One of two things compared with a number, not with the other one."""
    for compare in code.all(ast.Compare):
        sides = (compare.left, *compare.comparators)
        are_places = all(isinstance(side, (ast.Attribute, ast.Name)) for side in sides)
        if len(sides) == 2 and are_places and isinstance(compare.ops[0], (ast.Lt, ast.Gt, ast.LtE, ast.GtE)):
            for side in sides:
                for value in ("0.5", "1.0"):
                    yield code.replaced(side, value)


def elif_as_if(code: Code) -> Iterator[Edit]:
    """A second condition that is looked at in any case."""
    for node in code.all(ast.If):
        if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
            start, _ = code.span(node.orelse[0])
            if code.text.startswith("elif", start):
                yield code.head_replaced(node.orelse[0], "elif", "if")


OPERATORS = (turned, operand_left_out, bound, remembered, one_side, elif_as_if)
