"""State: first, last or largest for newest; kept from before; begun again; on the class; never written back."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from autograder.authoring.mutants.code import Code, Edit, called

if TYPE_CHECKING:
    from collections.abc import Iterator

_ENDPOINTS = ("create_publisher", "create_subscription", "create_client", "create_service", "create_timer")


def kept(code: Code) -> Iterator[Edit]:
    """A value different from the newest one in an attribute: the first, the largest, or the one before.

    The mutant collects all values in a list of the object. ``append`` returns None, so the expression
    ``X if seen.append(value) or True else 0`` adds the value and then is ``X``.
    """
    for assign, name in _attributes(code):
        function = code.function_of(assign)
        # Of values that are all the same, the first is the newest.
        if function is None or function.name == "__init__" or isinstance(assign.value, ast.Constant):
            continue
        value, attribute = code.source(assign.value), f"self.{name}"
        seen = f"self.__dict__.setdefault('_seen_{name}', [])"
        yield code.replaced(
            assign, f"{attribute} = {seen}[0] if {seen}.append({value}) or True else 0", "first"
        )
        for word in ("max", "min"):
            form = f"{attribute} = {word}({seen}) if {seen}.append({value}) or True else 0"
            yield code.replaced(assign, form, "largest" if word == "max" else "smallest")
        before = f"[{attribute}, *{seen}][-1 - ({seen}.append({value}) or 0)]"
        yield code.replaced(assign, f"{attribute} = {before}", "the one before")
        yield code.replaced(assign, f"{name} = {value}", "never written back")


def begun_again(code: Code) -> Iterator[Edit]:
    """State that begins again at each call of a method; what the constructor makes as it is only later."""
    first = {
        name: assign
        for assign, name in _attributes(code)
        if _is_of_init(code, assign) and not any(isinstance(one, ast.Call) for one in ast.walk(assign.value))
    }
    for function in code.functions():
        body = [one for one in function.body if not _is_text(one)]
        if function.name == "__init__" or not body or not code.stands_alone(body[0]):
            continue
        used = {node.attr for node in ast.walk(function) if isinstance(node, ast.Attribute)}
        for name in sorted(used & set(first)):
            yield code.before(body[0], f"self.{name} = {code.source(first[name].value)}", "at each call")
    for assign, name in _attributes(code):
        used = {node.id for node in ast.walk(assign.value) if isinstance(node, ast.Name)} - {"self"}
        if name in first and assign is not first[name] and not used:
            yield code.replaced(first[name].value, code.source(assign.value), "as later")


def on_the_class(code: Code) -> Iterator[Edit]:
    """State that belongs to the class: what one object leaves is there in the next one."""
    for assign, name in _attributes(code):
        definition = code.ancestor(assign, lambda node: isinstance(node, ast.ClassDef))
        if definition is None or not _is_of_init(code, assign) or not isinstance(assign.value, ast.Constant):
            continue
        assert isinstance(definition, ast.ClassDef)
        head = code.before(definition.body[0], f"{name} = {code.source(assign.value)}")
        rest = [code.replaced(assign, "pass")]
        for other, of in _attributes(code):
            if of == name and other is not assign:
                rest.append(code.head_replaced(other, "self", "type(self)"))
        yield replace(head, also=tuple(rest))


def made_once(code: Code) -> Iterator[Edit]:
    """A message that is made once and used again, with what it had before."""
    for call in code.all(ast.Call):
        function = code.function_of(call)
        name = called(call)
        is_plain = name[:1].isupper() and not (call.args or call.keywords)
        is_kept = isinstance(code.parents[call], ast.Assign)
        if is_plain and is_kept and function is not None and function.name != "__init__":
            yield code.replaced(
                call, f"{code.own_values(call)}.setdefault('_made_{name}', {code.source(call)})"
            )


def read_once(code: Code) -> Iterator[Edit]:
    """A value that is asked for once, and not each time; the default for a parameter."""
    defaults = {
        code.source(call.args[0]): code.source(call.args[1])
        for call in ast.walk(code.tree)
        if isinstance(call, ast.Call) and called(call) == "declare_parameter" and len(call.args) > 1
    }
    for attribute in code.all(ast.Attribute):
        call = attribute.value
        if called(call) == "get_parameter" and attribute.attr == "value" and isinstance(call, ast.Call):
            name = code.source(call.args[0])
            mark = f"self.__dict__.setdefault('_of_' + {name}, {code.source(attribute)})"
            yield code.replaced(attribute, mark, "once")
            if name in defaults:
                yield code.replaced(attribute, defaults[name], "default")


def _attributes(code: Code) -> Iterator[tuple[Any, str]]:
    """Yield each assignment of a value to an attribute of self that is not an endpoint, with the attribute's name."""
    for assign in code.all(ast.Assign, ast.AnnAssign):
        target: Any = assign.targets[0] if isinstance(assign, ast.Assign) else assign.target
        if assign.value is None or called(assign.value) in _ENDPOINTS:
            continue
        is_own = isinstance(target, ast.Attribute) and code.source(target.value) == "self"
        if is_own and code.stands_alone(assign):
            yield assign, target.attr


def _is_of_init(code: Code, node: ast.AST) -> bool:
    function = code.function_of(node)
    return function is not None and function.name == "__init__"


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


OPERATORS = (kept, begun_again, on_the_class, made_once, read_once)
