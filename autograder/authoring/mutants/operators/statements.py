"""Statements: dropped, doubled, in another order, done once only."""

from __future__ import annotations

import ast
from itertools import pairwise
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import SAYS, Code, Edit, called, paced

if TYPE_CHECKING:
    from collections.abc import Iterator

_SIMPLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.AnnAssign, ast.Raise, ast.Return, ast.Break)
_NO_MATTER = ("destroy_node", "destroy", "shutdown", "try_shutdown", "destroy_timer", "join")
"""Calls that a student may leave out (``docs/fairness.md``)."""
_EFFECTS = (
    *("ActionServer", "create_subscription", "create_service", "create_timer", "init", "publish"),
    *("publish_feedback", "append", "pop"),
    *("succeed", "abort", "canceled", "call", "call_async", "send_goal", "send_goal_async", "cancel"),
    *("cancel_goal", "cancel_goal_async", "get_result", "get_result_async"),
)
"""Calls whose second time others can see. A second node, client or publisher that is not used is not seen."""
_FREE_WORDS = ("flush", "args", "output")
"""Named arguments that a student may leave out: how soon a line is written, what ``init`` reads, where output goes."""


def dropped(code: Code) -> Iterator[Edit]:
    """A call, a raise, a return or a change of a variable that is not there."""
    for statement in code.all(ast.Expr, ast.AugAssign, ast.Raise, ast.Return, ast.Break):
        call = _call_of(statement)
        is_pause = call in ("sleep", "sleep_for") and not paced(code)
        is_exit_code = isinstance(statement, ast.Return) and isinstance(statement.value, ast.Constant)
        if call not in _NO_MATTER and not is_pause and not is_exit_code:
            yield code.replaced(statement, "pass")
    for assign in code.all(ast.Assign):
        # Without its first value a name would only be an error.
        if _is_set_elsewhere(code, assign):
            yield code.replaced(assign, "pass")


def _call_of(statement: ast.stmt) -> str:
    """Return the last name of the function that a statement calls; empty if it calls nothing."""
    value = getattr(statement, "value", None)
    return called(value.value if isinstance(value, ast.Await) else value) if value is not None else ""


def _is_set_elsewhere(code: Code, assign: ast.Assign) -> bool:
    target = code.source(assign.targets[0])
    return sum(target == code.source(other.targets[0]) for other in code.all(ast.Assign)) > 1


def doubled(code: Code) -> Iterator[Edit]:
    """A call with an effect that is made twice, a change that is made twice."""
    for statement in code.all(ast.Expr, ast.Assign, ast.AugAssign):
        call = _call_of(statement)
        does = call in _EFFECTS or isinstance(statement, ast.AugAssign)
        if does and code.stands_alone(statement):
            text = code.source(statement)
            yield code.replaced(statement, f"{text}\n{code.indentation(statement)}{text}")


def swapped(code: Code) -> Iterator[Edit]:
    """Two statements that follow each other, the other way round, where that can make a difference."""
    for body in code.bodies():
        for first, second in pairwise(body):
            matters = _depend(code, first, second) or _depend(code, second, first)
            matters = matters or (_acts(first) and _acts(second))
            if matters and isinstance(first, _SIMPLE) and isinstance(second, _SIMPLE):
                yield code.swapped(first, second)


def _depend(code: Code, first: ast.stmt, second: ast.stmt) -> bool:
    """Whether the second uses a variable that the first one sets."""
    targets = first.targets if isinstance(first, ast.Assign) else [getattr(first, "target", None)]
    made = {code.source(target) for target in targets if target is not None}
    used = {code.source(node) for node in ast.walk(second) if isinstance(node, (ast.Name, ast.Attribute))}
    return bool(made & used)


def _acts(statement: ast.stmt) -> bool:
    """Whether it does something that others see, or leaves."""
    call = _call_of(statement)
    return isinstance(statement, (ast.Return, ast.Raise, ast.Break)) or (
        bool(call) and call not in SAYS and call not in _NO_MATTER and isinstance(statement, ast.Expr)
    )


def only_once(code: Code) -> Iterator[Edit]:
    """A loop that is gone through once."""
    for loop in code.all(ast.While):
        yield code.head_replaced(loop, "while", "if")
    for repetition in code.all(ast.For):
        yield code.wrapped(repetition.iter, "list({})[:1]")


def keyword_dropped(code: Code) -> Iterator[Edit]:
    """A call without one of its named arguments that count."""
    for call in code.all(ast.Call):
        for keyword in call.keywords:
            counts = keyword.arg is not None and keyword.arg not in _FREE_WORDS
            if counts and called(call) not in ("dict", "Request", "Goal"):
                yield code.left_out(keyword)


def element_dropped_or_doubled(code: Code) -> Iterator[Edit]:
    """A list of nodes or actions with one less or one more; the one more has none of the rules."""
    for elements in code.all(ast.List):
        for element in elements.elts:
            if not isinstance(element, (ast.Call, ast.Name, ast.Tuple)):
                continue
            text = code.source(element)
            yield code.left_out(element)
            yield code.replaced(element, f"{text}, {text}")
            for keyword in element.keywords if isinstance(element, ast.Call) else ():
                if keyword.arg == "remappings":
                    plain = text.replace(code.source(keyword), "remappings=[]")
                    yield code.replaced(element, f"{text}, {plain}")


OPERATORS = (dropped, doubled, swapped, only_once, keyword_dropped, element_dropped_or_doubled)
