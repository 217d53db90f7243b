"""Values: message types, QoS, arithmetic, conditions."""

from __future__ import annotations

import ast
import re  # noqa: TID251  (not what a student handed in)
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import Code, Edit, argument, called
from autograder.authoring.mutants.operators.names import ENDPOINTS
from autograder.authoring.mutants.operators.numbers import depth_of

if TYPE_CHECKING:
    from collections.abc import Iterator

_MOMENT = re.compile("time|deadline|until|give_up")
_OTHER_TYPES = {
    "String": '__import__("std_msgs.msg").msg.Char',
    "AddTwoInts": '__import__("std_srvs.srv").srv.SetBool',
    "Trigger": '__import__("std_srvs.srv").srv.SetBool',
}
_OTHER_QOS = {
    "create_publisher": '__import__("rclpy").qos.qos_profile_sensor_data',
    "create_subscription": (
        '__import__("rclpy").qos.QoSProfile(depth=10, '
        'durability=__import__("rclpy").qos.DurabilityPolicy.TRANSIENT_LOCAL)'
    ),
}
"""Profiles that the other end of the course cannot match."""
_POLICIES = {
    "RELIABLE": "BEST_EFFORT",
    "BEST_EFFORT": "RELIABLE",
    "VOLATILE": "TRANSIENT_LOCAL",
    "TRANSIENT_LOCAL": "VOLATILE",
    "KEEP_ALL": "KEEP_LAST",
}
_COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", ">="),
}
_ARITHMETIC: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Mod: ("%", "//"),
}


def message_type(code: Code) -> Iterator[Edit]:
    """An endpoint of another type."""
    for call in code.all(ast.Call):
        if called(call) in ENDPOINTS:
            kind = argument(call, 1 if called(call).startswith("Action") else 0, "")
            name = code.source(kind).rpartition(".")[2] if kind is not None else ""
            if kind is not None and name in _OTHER_TYPES:
                yield code.replaced(kind, _OTHER_TYPES[name])


def qos(code: Code) -> Iterator[Edit]:
    """A QoS that the given other end does not match, another policy."""
    for call in code.all(ast.Call):
        profile = depth_of(call)
        if profile is not None:
            yield code.replaced(profile, _OTHER_QOS[called(call)])
    for attribute in code.all(ast.Attribute):
        if attribute.attr in _POLICIES:
            _, end = code.span(attribute)
            yield Edit(end - len(attribute.attr), end, _POLICIES[attribute.attr], code.where(attribute))


def arithmetic(code: Code) -> Iterator[Edit]:
    """Plus for minus, and the like."""
    for operation in code.all(ast.BinOp):
        pair = _ARITHMETIC.get(type(operation.op))
        if pair is None or isinstance(operation.left, (ast.JoinedStr, ast.List)) or _is_text(operation.left):
            continue
        yield _operator_replaced(code, operation, operation.left, operation.right, *pair)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def comparison(code: Code) -> Iterator[Edit]:
    """A border that is one off."""
    for compare in code.all(ast.Compare):
        left = compare.left
        for operator, right in zip(compare.ops, compare.comparators, strict=True):
            pair = _COMPARISONS.get(type(operator))
            # Nobody can tell whether the very last moment still counts.
            if pair is not None and not _MOMENT.search(code.source(compare)):
                yield _operator_replaced(code, compare, left, right, *pair)
            left = right


def connective(code: Code) -> Iterator[Edit]:
    """And for or."""
    for operation in code.all(ast.BoolOp):
        pair = ("and", "or") if isinstance(operation.op, ast.And) else ("or", "and")
        yield _operator_replaced(code, operation, operation.values[0], operation.values[1], *pair)


def _operator_replaced(
    code: Code, around: ast.AST, left: ast.expr, right: ast.expr, old: str, new: str
) -> Edit:
    between, end = code.span(left)[1], code.span(right)[0]
    start = code.text.index(old, between, end)
    return Edit(start, start + len(old), new, code.where(around))


def condition(code: Code) -> Iterator[Edit]:
    """A condition that is turned round, always holds, or never."""
    for node in code.all(ast.If, ast.While, ast.IfExp):
        if "__name__" not in code.source(node.test):
            yield code.wrapped(node.test, "not ({})", "turned")
            yield code.replaced(node.test, "True", "always")
            yield code.replaced(node.test, "False", "never")


OPERATORS = (message_type, qos, arithmetic, comparison, connective, condition)
