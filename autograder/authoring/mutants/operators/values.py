"""Values: message types, QoS, arithmetic, conditions."""

from __future__ import annotations

import ast
import re  # noqa: TID251  (not what a student handed in)
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import SIGNS, Code, Edit, argument, called, text_of
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
_COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": ">="}
_ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "//"}


def message_type(code: Code) -> Iterator[Edit]:
    """An endpoint of another type."""
    for call in code.calls(*ENDPOINTS):
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
            yield code.tail_replaced(attribute, attribute.attr, _POLICIES[attribute.attr])


def arithmetic(code: Code) -> Iterator[Edit]:
    """Plus for minus, and the like."""
    for operation in code.all(ast.BinOp):
        left, sign = operation.left, SIGNS.get(type(operation.op), "")
        if sign in _ARITHMETIC and not isinstance(left, (ast.JoinedStr, ast.List)) and text_of(left) is None:
            yield code.sign_replaced(left, operation.right, sign, _ARITHMETIC[sign])


def comparison(code: Code) -> Iterator[Edit]:
    """A border that is one off."""
    for compare, left, sign, right in code.comparisons():
        # Nobody can tell whether the very last moment still counts.
        if sign in _COMPARISONS and not _MOMENT.search(code.source(compare)):
            yield code.sign_replaced(left, right, sign, _COMPARISONS[sign])


def connective(code: Code) -> Iterator[Edit]:
    """And for or."""
    for operation in code.all(ast.BoolOp):
        word, (left, right, *_) = SIGNS[type(operation.op)], operation.values
        yield code.sign_replaced(left, right, word, "or" if word == "and" else "and")


def condition(code: Code) -> Iterator[Edit]:
    """A condition that is turned round, always holds, or never."""
    for node in code.all(ast.If, ast.While, ast.IfExp):
        if "__name__" not in code.source(node.test):
            yield code.wrapped(node.test, "not ({})", "turned")
            yield code.replaced(node.test, "True", "always")
            yield code.replaced(node.test, "False", "never")


OPERATORS = (message_type, qos, arithmetic, comparison, connective, condition)
