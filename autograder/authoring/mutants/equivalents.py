"""Sets mutants aside that do what the solution does, by rules that hold for every exercise."""

from __future__ import annotations

import ast
import itertools
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.authoring.mutants.code import Code, called

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.authoring.mutants.engine import Mutant

NAME = "the name of a node is free"
EXCHANGED = "min and max take their arguments in any order"
EDGE = "no drawing is exactly at a number that 32 bits do not hold, or at the very end of a time"
DECLARED = "the order of declarations is free"
ONE_OBJECT = "the judge makes one node for each drawing"
IMPLIED = "the branch before, or after, says the same already"
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
    if operator == "node_name":
        return NAME
    if operator == "on_the_class" and _is_class(code, root):
        return ONE_OBJECT
    if operator == "exchanged":
        around = _around(code, mutant.start, end, ast.Call)
        return EXCHANGED if called(around) in ("min", "max") else ""  # type: ignore[arg-type]
    if operator == "comparison":
        around = _around(code, mutant.start, end, ast.Compare)
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
    if operator in ("operand_left_out", "elif_as_if", "connective", "condition"):
        return IMPLIED if _same_branches(code, mutant) else ""
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


def _around(code: Code, start: int, end: int, kind: type[ast.AST]) -> ast.AST | None:
    """Return the smallest node of a kind around a place."""
    spans = [(node, code.span(node)) for node in code.all(kind)]
    fits = [
        (last - first, number)
        for number, (_, (first, last)) in enumerate(spans)
        if first <= start and end <= last
    ]
    return spans[min(fits)[1]][0] if fits else None


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


@dataclass(frozen=True)
class _Values:
    """Makes what conditions look at take all values that can make a difference.

    Attributes:
        atoms: What is looked at, as it is written: a name, an attribute or a call.
        values: The values that each takes.
    """

    atoms: tuple[str, ...]
    values: tuple[tuple[Any, ...], ...]

    def all(self) -> Iterator[dict[str, Any]]:
        """Yield all combinations, by what is looked at."""
        for combination in itertools.product(*self.values):
            yield dict(zip(self.atoms, combination, strict=True))


_MOST = 20_000
"""The greatest number of combinations that are tried."""


def _same_branches(code: Code, mutant: Mutant) -> bool:
    """Return True if an ``if`` chooses the same branches in the mutant whatever its conditions look at.

    An attribute that the first branch sets may have any value when the second condition is looked at.
    """
    end = mutant.start + len(mutant.before)
    chain = _around(code, mutant.start, end, ast.If)
    while chain is not None and isinstance(code.parents.get(chain), ast.If):
        above = code.parents[chain]
        if not (isinstance(above, ast.If) and above.orelse == [chain]):
            break
        chain = above
    if not isinstance(chain, ast.If):
        return False
    tests, bodies = _branches(chain)
    is_in_a_test = any(first <= mutant.start and end <= last for first, last in map(code.span, tests))
    if not is_in_a_test and mutant.operator != "elif_as_if":
        return False
    changed = _mutated(code, mutant, chain)
    if changed is None:
        return False
    others, independent = changed
    if len(others) != len(tests):
        return False
    values = _values([*tests, *others])
    if values is None:
        return False
    for seen in values.all():
        if _chosen(tests, bodies, seen, values, independent=False) != _chosen(
            others, bodies, seen, values, independent=independent
        ):
            return False
    return True


def _branches(chain: ast.If) -> tuple[list[ast.expr], list[list[ast.stmt]]]:
    tests, bodies = [chain.test], [chain.body]
    while len(chain.orelse) == 1 and isinstance(chain.orelse[0], ast.If):
        chain = chain.orelse[0]
        tests.append(chain.test)
        bodies.append(chain.body)
    return tests, bodies


def _mutated(code: Code, mutant: Mutant, chain: ast.If) -> tuple[list[ast.expr], bool] | None:
    """Return the conditions in the mutant, and whether the second is looked at in any case."""
    tree = ast.parse(mutant.text)
    found = [one for one in ast.walk(tree) if isinstance(one, ast.If) and one.lineno == chain.lineno]
    if not found:
        return None
    tests, _ = _branches(found[0])
    if mutant.operator != "elif_as_if":
        return tests, False
    line = code.line(mutant.start)
    second = [one for one in ast.walk(tree) if isinstance(one, ast.If) and one.lineno == line]
    if not second:
        return None
    more, _ = _branches(second[0])
    return ([*tests, *more], True) if len(tests) == 1 else None


def _chosen(
    tests: Sequence[ast.expr],
    bodies: Sequence[Sequence[ast.stmt]],
    seen: dict[str, Any],
    values: _Values,
    *,
    independent: bool,
) -> tuple[int, ...]:
    """Return which branches are taken."""
    holds = [bool(_value(test, seen)) for test in tests]
    first = next((number for number, held in enumerate(holds) if held), -1)
    if not (independent and holds[0]):
        return (first,)
    set_there = {ast.unparse(node) for one in bodies[0] for node in ast.walk(one) if _is_set(node)}
    for other in values.all():
        later = {atom: other[atom] if atom in set_there else seen[atom] for atom in seen}
        if any(_value(test, later) for test in tests[1:]):
            return (first, 1)
    return (first,)


def _is_set(node: ast.AST) -> bool:
    return isinstance(node, (ast.Attribute, ast.Name)) and isinstance(node.ctx, ast.Store)


def _values(tests: Sequence[ast.expr]) -> _Values | None:
    """Return the values to try; None if a condition looks at something that has no such values."""
    found: dict[str, set[Any]] = {}
    for test in tests:
        for node in _atoms(test):
            found.setdefault(ast.unparse(node), {True, False})
        for compare in ast.walk(test):
            if isinstance(compare, ast.Compare):
                sides = [compare.left, *compare.comparators]
                constants = [side.value for side in sides if isinstance(side, ast.Constant)]
                for side in sides:
                    if not isinstance(side, ast.Constant):
                        found[ast.unparse(side)] = (
                            found.get(ast.unparse(side), set()) - {True, False}
                        ) | _near(constants)
    values = tuple(tuple(one) for one in found.values())
    count = 1
    for one in values:
        count *= len(one)
    return (
        _Values(tuple(found), values)
        if values and count * count <= _MOST * _MOST and count <= _MOST
        else None
    )


def _near(constants: Sequence[Any]) -> set[Any]:
    values: set[Any] = set()
    for constant in constants:
        if isinstance(constant, (int, float)) and not isinstance(constant, bool):
            values |= {constant - 1e-3, float(constant), constant + 1e-3}
        else:
            values |= {constant, f"not {constant}"}
    return values or {1.0, 2.0, 3.0}


def _atoms(test: ast.expr) -> Iterator[ast.expr]:
    if isinstance(test, ast.BoolOp):
        for value in test.values:
            yield from _atoms(value)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        yield from _atoms(test.operand)
    elif isinstance(test, ast.Compare):
        yield from (side for side in (test.left, *test.comparators) if not isinstance(side, ast.Constant))
    elif not isinstance(test, ast.Constant):
        yield test


def _value(test: ast.expr, seen: dict[str, Any]) -> Any:
    """Evaluate a condition, given what it looks at."""
    if isinstance(test, ast.BoolOp):
        values = (_value(value, seen) for value in test.values)
        return all(values) if isinstance(test.op, ast.And) else any(values)
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return not _value(test.operand, seen)
    if isinstance(test, ast.Compare):
        sides = [
            side.value if isinstance(side, ast.Constant) else seen[ast.unparse(side)]
            for side in (test.left, *test.comparators)
        ]
        pairs = zip(test.ops, itertools.pairwise(sides), strict=True)
        return all(_compared(operator, *pair) for operator, pair in pairs)
    return test.value if isinstance(test, ast.Constant) else seen[ast.unparse(test)]


def _compared(operator: ast.cmpop, one: Any, other: Any) -> bool:
    if isinstance(operator, (ast.Eq, ast.Is)):
        return bool(one == other)
    if isinstance(operator, (ast.NotEq, ast.IsNot)):
        return bool(one != other)
    try:
        return bool(
            {ast.Lt: one < other, ast.LtE: one <= other, ast.Gt: one > other, ast.GtE: one >= other}[
                type(operator)
            ]
        )
    except (TypeError, KeyError):
        return False
