"""Numbers: another one, another unit, another sign, the number of another place."""

from __future__ import annotations

import ast
from itertools import combinations
from typing import TYPE_CHECKING, Any

from autograder.authoring.mutants.code import Code, Edit, given, paced
from autograder.authoring.mutants.operators.waiting import limit_of, limits, pace_of

if TYPE_CHECKING:
    from collections.abc import Iterator

FACTORS = (0.1, 0.5, 0.8, 0.9, 1.1, 1.25, 1.5, 2.0, 10.0)
"""The factors between the right number and one that a student has misread or guessed."""
UNITS = (0.001, 0.01, 100.0, 1000.0)
"""Between milliseconds, centimeters, percent and what the course uses: seconds, meters and shares of one."""
_QOS = {"create_publisher": (2, "qos_profile"), "create_subscription": (3, "qos_profile")}


def depth_of(call: ast.Call) -> ast.expr | None:
    """Return the QoS, or the depth of the queue, that is given for a publisher or a subscription."""
    return given(call, _QOS)


def number(code: Code) -> Iterator[Edit]:
    """Another number: a neighbor, or a multiple."""
    for constant in numbers(code):
        value = constant.value
        if isinstance(value, int):
            yield code.replaced(constant, str(value + 1), "one more")
            yield code.replaced(constant, str(value - 1) if value else "(-1)", "one less")
        for factor in FACTORS if value else ():
            yield code.replaced(constant, _written(value, factor), f"times {factor:g}")


def unit(code: Code) -> Iterator[Edit]:
    """A number in another unit, or for another unit."""
    for constant in numbers(code):
        for factor in UNITS if constant.value else ():
            yield code.replaced(constant, _written(constant.value, factor), f"times {factor:g}")
    for call in code.calls("Duration"):
        for keyword in call.keywords:
            if keyword.arg == "seconds":
                yield code.head_replaced(keyword, "seconds", "nanoseconds", "nanoseconds")


def sign(code: Code) -> Iterator[Edit]:
    """A sign that is lost, or that is too many; zero for a negative bound."""
    for constant in numbers(code):
        is_signed = isinstance(code.parents[constant], ast.UnaryOp)
        if isinstance(constant.value, float) and constant.value and not is_signed:
            yield code.replaced(constant, f"-{constant.value}", "turned")
    for operation in code.all(ast.UnaryOp):
        if isinstance(operation.op, ast.USub):
            yield code.replaced(operation, code.source(operation.operand), "lost")
            yield code.replaced(operation, "0.0", "zero")
    for attribute in code.all(ast.Attribute):
        # Only these fields can be negative, among those of the messages that robots use most.
        is_read = isinstance(attribute.ctx, ast.Load) and not isinstance(
            code.parents[attribute], ast.Attribute
        )
        if attribute.attr in ("x", "y", "z") and is_read:
            yield code.wrapped(attribute, "abs({})", "size alone")
            yield code.wrapped(attribute, "(-{})", "turned")


def number_of_another_place(code: Code) -> Iterator[Edit]:
    """A number that stands elsewhere in the same method, or two that change places."""
    groups: dict[str, list[Any]] = {}
    for constant in numbers(code):
        groups.setdefault(code.where(constant), []).append(constant)
    for group in groups.values():
        for constant in group:
            for value in sorted({one.value for one in group} - {constant.value}):
                yield code.replaced(constant, repr(value))
        for one, other in combinations(group, 2):
            if one.value != other.value:
                yield code.exchanged(one, other)


def numbers(code: Code) -> Iterator[Any]:
    """Yield the numbers that count.

    Depths, limits, exit codes and the pace of a program that publishes nothing are free, or the matter of another
    operator.
    """
    free = {place for call in code.all(ast.Call) for place in (depth_of(call), limit_of(call))}
    free |= {word.value for call in code.all(ast.Call) for word in call.keywords if word.arg == "depth"}
    free |= {returned.value for returned in code.all(ast.Return)} | set(limits(code))
    if not paced(code):
        free |= {pace_of(call) for call in code.all(ast.Call)}
    for constant in code.all(ast.Constant):
        is_number = isinstance(constant.value, (int, float)) and not isinstance(constant.value, bool)
        if is_number and constant not in free:
            yield constant


def _written(value: float, factor: float) -> str:
    scaled = value * factor
    return str(int(scaled)) if isinstance(value, int) and scaled == int(scaled) else f"{scaled:.6g}"


OPERATORS = (number, unit, sign, number_of_another_place)
