"""Sets mutants aside that do what the solution does, by rules that hold for every exercise."""

from __future__ import annotations

import ast
import struct
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import Code, called

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.authoring.mutants.engine import Mutant

EXCHANGED = "min and max take their arguments in any order"
EDGE = "no drawing is exactly at a number that 32 bits do not hold, or at the very end of a time"
DECLARED = "the order of declarations is free"
ONE_OBJECT = "the judge makes one node for each drawing"
FORWARD = "time does not go back, so the newest is the latest"
FIRST_NONE = "what has been set once is never None again"
SET_BEFORE = "it is set before it is read"
ONCE_MORE = "a second subscription keeps the same value once more"
_DECLARES = (
    *("create_publisher", "create_subscription", "create_service", "create_client", "create_timer"),
    *("declare_parameter", "add_on_set_parameters_callback"),
)


def equivalent(code: Code, mutant: Mutant, root: str = "") -> str:
    """Return why a mutant does what its program does; empty if no rule says so.

    Args:
        code: The program.
        mutant: The mutant.
        root: The name of the class or function that is judged; empty if it is the program.
    """
    operator, end = mutant.operator, mutant.start + len(mutant.before)
    if operator == "on_the_class" and _is_class(code, root):
        return ONE_OBJECT
    if operator == "exchanged":
        around = code.smallest(code.all(ast.Call), mutant.start, end)
        return EXCHANGED if called(around) in ("min", "max") else ""
    if operator == "comparison":
        around = code.smallest(code.all(ast.Compare), mutant.start, end)
        return EDGE if around is not None and _has_no_edge(code, around) else ""
    if operator == "swapped":
        first = next(one for one in code.all(ast.stmt) if code.span(one)[0] == mutant.start)
        return DECLARED if all(_declares(one) for one in _pair(code, first)) else ""
    if operator == "doubled" and "create_subscription" in mutant.before:
        return ONCE_MORE if _only_keeps(code, mutant) else ""
    if operator == "kept" and mutant.kind == "largest" and ".now()" in mutant.before:
        return FORWARD
    if operator == "remembered" and mutant.kind == "once false" and mutant.before.endswith(" is None"):
        return FIRST_NONE
    if operator == "remembered" and mutant.kind == "once true" and mutant.before.endswith(" is not None"):
        return FIRST_NONE
    if operator == "begun_again" and mutant.kind == "at each call":
        return SET_BEFORE if _sets_first(code, mutant) else ""
    return ""


def _only_keeps(code: Code, mutant: Mutant) -> bool:
    """Return True if the callback of a subscription only stores what follows from the message."""
    calls = (one for one in code.all(ast.Call) if called(one) == "create_subscription")
    call = next(one for one in calls if code.span(one)[0] >= mutant.start)
    method = code.method(call.args[2]) if len(call.args) > 2 else None
    body = [one for one in method.body if not isinstance(one, ast.Expr)] if method is not None else []
    return bool(body) and all(isinstance(one, (ast.Assign, ast.AnnAssign)) for one in body)


def _is_class(code: Code, root: str) -> bool:
    return any(isinstance(one, ast.ClassDef) and one.name == root for one in code.tree.body)


def _has_no_edge(code: Code, compare: ast.AST) -> bool:
    source = code.source(compare)
    if "Duration" in source or "now()" in source:
        return True
    numbers = [node.value for node in ast.walk(compare) if isinstance(node, ast.Constant)]
    floats = [value for value in numbers if isinstance(value, float)]
    return any(struct.unpack("f", struct.pack("f", value))[0] != value for value in floats)


def _pair(code: Code, statement: ast.stmt) -> Sequence[ast.stmt]:
    for body in code.bodies():
        if statement in body:
            place = body.index(statement)
            return body[place : place + 2]
    return [statement]


def _declares(statement: ast.stmt) -> bool:
    value = getattr(statement, "value", None)
    is_plain = isinstance(statement, (ast.Assign, ast.AnnAssign)) and isinstance(value, ast.Constant)
    return is_plain or (value is not None and called(value) in _DECLARES)


def _sets_first(code: Code, mutant: Mutant) -> bool:
    """Return True if a method sets an attribute anyway, before it reads it; or never reads it."""
    name = mutant.after.partition(" = ")[0]
    short = mutant.where.rpartition(".")[2]
    for function in code.functions():
        if function.name == short and code.where(function.body[0]) == mutant.where:
            for node in _in_order(function):
                if isinstance(node, ast.Attribute) and code.source(node) == name:
                    return isinstance(node.ctx, ast.Store) and _is_at_the_top(code, node, function)
    return False


def _in_order(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes below another one in the order in which Python evaluates them: what is assigned comes last."""
    children = list(ast.iter_child_nodes(node))
    if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)) and node.value is not None:
        children = [node.value, *(child for child in children if child is not node.value)]
    for child in children:
        yield from _in_order(child)
        yield child


def _is_at_the_top(code: Code, node: ast.AST, function: ast.AST) -> bool:
    statement = code.ancestor(node, lambda one: isinstance(one, ast.stmt))
    return statement is not None and code.parents.get(statement) is function
