"""Outputs: printed, not returned; said too seldom; by a timer, not at an input; on another clock; another word."""

from __future__ import annotations

import ast
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from autograder.authoring.mutants.code import Code, Edit, called, text_of

if TYPE_CHECKING:
    from collections.abc import Iterator

_TELLS = ("publish", "tell")
_NAMES = (
    *("create_publisher", "create_subscription", "create_client", "create_service", "__init__"),
    *("get_parameter", "declare_parameter", "has_parameter"),
)
"""Calls whose texts are names, which other operators change."""
_OWN_CLOCK = "__import__('rclpy.clock').clock.Clock().now()"


def printed(code: Code) -> Iterator[Edit]:
    """Printed, and not returned or published; nothing in one of two cases."""
    for returned in code.all(ast.Return):
        if returned.value is not None:
            yield code.replaced(returned, f"print({code.source(returned.value)})", "returned")
        if isinstance(returned.value, ast.IfExp):
            for branch in (returned.value.body, returned.value.orelse):
                yield code.replaced(branch, "None", "nothing in one case")
    for said in _said(code):
        given = ", ".join(code.source(value) for value in said.value.args)
        yield code.replaced(said, f"print({given})", "published")


def seldom(code: Code) -> Iterator[Edit]:
    """Said only if it is new, only once, or only in one of two cases."""
    for said in _said(code):
        if not code.stands_alone(said):
            continue
        source, indentation = code.source(said), code.indentation(said)
        value = ", ".join(f"str({code.source(one)})" for one in said.value.args)
        last = f"self.__dict__.setdefault('_last_{code.mark(said)}', [None])"
        is_new = f"if {last}[-1] != ({value},): {source}\n{indentation}{last}.append(({value},))"
        yield code.replaced(said, is_new, "only if new")
        name = f"_once_{code.mark(said)}"
        once = f"if not hasattr(self, '{name}'): {source}\n{indentation}self.{name} = 1"
        yield code.replaced(said, once, "only once")
        function = code.function_of(said)
        for before in function.body if function is not None else ():
            if isinstance(before, ast.If) and (before.end_lineno or 0) < said.lineno:
                test = code.source(before.test)
                yield code.replaced(said, f"if {test}: {source}", "only if")
                yield code.replaced(said, f"if not ({test}): {source}", "only if not")


def _said(code: Code) -> Iterator[Any]:
    for statement in code.all(ast.Expr):
        if called(statement.value) in _TELLS:
            yield statement


def at_another_event(code: Code) -> Iterator[Edit]:
    """Done at each input for by the timer, and the other way round."""
    timers = [call for call in code.calls("create_timer") if len(call.args) > 1]
    inputs = [call for call in code.calls("create_subscription") if len(call.args) > 2]
    for timer in timers:
        for heard in inputs:
            method, act = code.method(heard.args[2]), code.source(timer.args[1])
            if method is not None and method.name != act.rpartition(".")[2]:
                last = method.body[-1]
                if code.stands_alone(last):
                    yield replace(code.replaced(timer, "None"), also=(code.after(last, f"{act}()"),))
    for heard in inputs if not timers else ():
        callback, statement = heard.args[2], code.parents[heard]
        if isinstance(statement, ast.Expr) and code.stands_alone(statement):
            keeps = code.replaced(callback, "lambda message: self.__dict__.update(_message=message)")
            acts = f"lambda: '_message' in self.__dict__ and {code.source(callback)}(self._message)"
            yield replace(keeps, also=(code.after(statement, f"self.create_timer(0.5, {acts})"),))


def other_clock(code: Code) -> Iterator[Edit]:
    """The computer's clock for the robot's; the time in a message for the time when it came."""
    for call in code.all(ast.Call):
        if code.source(call) == "self.get_clock().now()":
            yield code.replaced(call, _OWN_CLOCK, "the computer's")
            function = code.function_of(call)
            given = [one.arg for one in function.args.args[1:]] if function is not None else []
            if isinstance(code.parents[call], ast.Assign) and len(given) == 1:
                stamp = f"{given[0]}.header.stamp"
                kind = "__import__('rclpy.clock').clock.ClockType.ROS_TIME"
                yield code.replaced(
                    call, f"__import__('rclpy.time').time.Time.from_msg({stamp}, {kind})", "stamp"
                )


def other_word(code: Code) -> Iterator[Edit]:
    """A word for another one, a word that is written otherwise; the name of another parameter."""
    said, names = [], []
    for constant in code.all(ast.Constant):
        parent = code.parents[constant]
        if not text_of(constant):
            continue
        if called(parent) in ("get_parameter", "declare_parameter"):
            names.append(constant)
        elif called(parent) not in _NAMES and not isinstance(parent, (ast.JoinedStr, ast.FormattedValue)):
            said.append(constant)
    for constant in said:
        of_the_class = {one.value for one in said if _definition(code, one) == _definition(code, constant)}
        for other in sorted(of_the_class - {constant.value}):
            yield code.replaced(constant, repr(other), f"for {constant.value}")
        yield code.replaced(constant, repr(constant.value.capitalize()), "capital")
        yield code.replaced(constant, repr(f"{constant.value}."), "dot")
    for constant in names:
        for other in sorted({one.value for one in names} - {constant.value}):
            yield code.replaced(constant, repr(other), f"for {constant.value}")
    for one in said:
        for other in said:
            if one.lineno == other.lineno and one.col_offset < other.col_offset and one.value != other.value:
                yield code.exchanged(one, other)


def _definition(code: Code, node: ast.AST) -> str:
    return code.where(node).partition(".")[0]


def range_of_parameter(code: Code) -> Iterator[Edit]:
    """A parameter without its range."""
    for call in code.calls("declare_parameter"):
        if len(call.args) == 3:
            name, default, _ = call.args
            text = f"{code.source(call.func)}({code.source(name)}, {code.source(default)})"
            yield code.replaced(call, text, "no range")


def moved(code: Code) -> Iterator[Edit]:
    """A statement that comes only after the condition behind it."""
    for body in code.bodies():
        for statement, condition in pairwise(body):
            is_simple = isinstance(statement, (ast.Assign, ast.AugAssign, ast.Expr))
            if is_simple and isinstance(condition, ast.If) and code.stands_alone(statement):
                start, _ = code.span(statement)
                begin, end = code.span(condition)
                text = f"{code.text[begin:end]}\n{code.indentation(statement)}{code.source(statement)}"
                yield Edit(start, end, text, code.where(statement))


def threads_of_another_kind(code: Code) -> Iterator[Edit]:
    """No thread, one at a time, or none while one is at work."""
    for statement in code.all(ast.Expr):
        call = statement.value
        thread: Any = call.func.value if called(call) == "start" else call
        if called(thread) != "Thread" or thread is call or not code.stands_alone(statement):
            continue
        words = {word.arg: word.value for word in thread.keywords}
        target, given = words.get("target"), words.get("args")
        if target is None or not isinstance(given, ast.Tuple):
            continue
        arguments = ", ".join(code.source(one) for one in given.elts)
        does, indentation = code.source(target), code.indentation(statement)
        yield code.replaced(statement, f"{does}({arguments})", "no thread")
        waits = "lambda *given, before=self.__dict__.get('_thread'):"
        waits = f"({waits} (before and before.join(), {does}(*given)))"
        one = code.source(thread).replace(does, waits, 1)
        text = f"self._thread = {one}\n{indentation}self._thread.start()"
        yield code.replaced(statement, text, "one at a time")
        is_free = f"if not (self.__dict__.get('_thread') and self._thread.is_alive()):\n{indentation}    "
        text = f"{is_free}self._thread = {code.source(thread)}; self._thread.start()"
        yield code.replaced(statement, text, "none while one works")


OPERATORS = (
    *(printed, seldom, at_another_event, other_clock, other_word),
    *(range_of_parameter, moved, threads_of_another_kind),
)
