"""Waiting: too short, for ever, not at all; spinning, threads, groups; what goes wrong only later."""

from __future__ import annotations

import ast
import re  # noqa: TID251  (not what a student handed in)
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import Code, Edit, called, given, paced

if TYPE_CHECKING:
    from collections.abc import Iterator

_LIMITS = {
    "wait_for_service": (0, "timeout_sec"),
    "wait_for_server": (0, "timeout_sec"),
    "spin_until_future_complete": (2, "timeout_sec"),
    "wait_for": (2, "patience_sec"),
    "spin_once": (1, "timeout_sec"),
    "wait": (0, "timeout"),
    "join": (0, "timeout"),
}
"""The place of the limit in a call that waits."""
_PACES = {
    "sleep": (0, "seconds"),
    "sleep_for": (0, "rel_time"),
    "pause": (0, "seconds"),
    "create_timer": (0, "timer_period_sec"),
    "MultiThreadedExecutor": (0, "num_threads"),
}
"""The place of the pace in a call; the number of threads is as free as a pace."""
_LIMIT_NAME = re.compile("patience|timeout|limit|deadline", re.IGNORECASE)
_CLOCKS = ("monotonic", "time", "perf_counter")
_WAITS = ("wait_for_service", "wait_for_server", "wait", "done", "service_is_ready", "server_is_ready")
_CALLBACKS = {
    "create_timer": (1, "callback"),
    "create_subscription": (2, "callback"),
    "create_service": (2, "callback"),
    "ActionServer": (3, "execute_callback"),
    "send_goal_async": (1, "feedback_callback"),
}
"""The place of a callback, which is called again and again, in the call that registers it."""
_LATE = (7, 12)
"""After how many calls a callback dies or goes deaf."""


def impatient(code: Code) -> Iterator[Edit]:
    """A limit of a hundredth of a second, and none for a server; a moment that is almost or long over."""
    for call in code.all(ast.Call):
        limit = limit_of(call)
        if limit is not None:
            yield code.replaced(limit, "0.01")
            if called(call) in ("wait_for_service", "wait_for_server"):
                yield code.replaced(limit, "None")
    for limit in limits(code):
        yield code.replaced(limit, "0.01")
        yield code.wrapped(limit, "(-{})")


def limits(code: Code) -> Iterator[ast.expr]:
    """The limits that do not stand in the call that waits: in a default, in a constant, behind the present time."""
    for function in code.functions():
        defaults = function.args.defaults
        for argument, default in zip(function.args.args[-len(defaults) :], defaults, strict=False):
            if _LIMIT_NAME.search(argument.arg):
                yield default
    for assign in code.all(ast.Assign):
        if _LIMIT_NAME.search(code.source(assign.targets[0])) and isinstance(assign.value, ast.Constant):
            yield assign.value
    for operation in code.all(ast.BinOp):
        if isinstance(operation.op, ast.Add) and called(operation.left) in _CLOCKS:
            yield operation.right


def limit_of(call: ast.Call) -> ast.expr | None:
    """The limit that is given for a wait."""
    return given(call, _LIMITS)


def restless(code: Code) -> Iterator[Edit]:
    """A pause or a period of a hundredth of a second."""
    for call in code.all(ast.Call) if paced(code) else ():
        pace = pace_of(call)
        if pace is not None and called(call) != "MultiThreadedExecutor":
            yield code.replaced(pace, "0.01")


def pace_of(call: ast.Call) -> ast.expr | None:
    """The pause or the period that is given to a call."""
    return given(call, _PACES)


def taken_for_granted(code: Code) -> Iterator[Edit]:
    """Whatever is waited for is taken to be there."""
    for call in code.calls(*_WAITS):
        if not isinstance(code.parents[call], ast.Expr):
            yield code.replaced(call, "True")


def hardly_spun(code: Code) -> Iterator[Edit]:
    """Spun once, or for a hundredth of a second."""
    for call in code.all(ast.Call):
        name = called(call)
        if name == "spin" and call.args:
            yield code.replaced(call, f"__import__('rclpy').spin_once({code.source(call.args[0])})")
        elif name == "spin" and isinstance(call.func, ast.Attribute):
            yield code.replaced(call, f"{code.source(call.func.value)}.spin_once()")
        elif name == "spin_until_future_complete" and len(call.args) >= 2:
            node = code.source(call.args[0])
            yield code.replaced(call, f"__import__('rclpy').spin_once({node}, timeout_sec=0.01)")
            yield code.replaced(call, f"__import__('rclpy').spin_once({node})")


def not_awaited(code: Code) -> Iterator[Edit]:
    """Without the await."""
    for awaited in code.all(ast.Await):
        yield code.replaced(awaited, code.source(awaited.value))


def threads(code: Code) -> Iterator[Edit]:
    """One thread, or one group, where several are needed."""
    for call in code.all(ast.Call):
        if called(call) == "MultiThreadedExecutor":
            yield code.replaced(call, "__import__('rclpy.executors').executors.SingleThreadedExecutor()")
        elif called(call) == "ReentrantCallbackGroup":
            group = "__import__('rclpy.callback_groups').callback_groups.MutuallyExclusiveCallbackGroup()"
            yield code.replaced(call, group)


def answer(code: Code) -> Iterator[Edit]:
    """Accept for reject; a goal that ends otherwise."""
    endings = ("succeed", "abort", "canceled")
    others = {name: [other for other in endings if other != name] for name in endings}
    others |= {"ACCEPT": ["REJECT"], "REJECT": ["ACCEPT"]}
    for attribute in code.all(ast.Attribute):
        if attribute.attr in endings and not isinstance(code.parents[attribute], ast.Call):
            continue
        for other in others.get(attribute.attr, ()):
            yield code.tail_replaced(attribute, attribute.attr, other)


def late(code: Code) -> Iterator[Edit]:
    """A callback that sleeps, or that dies or goes deaf after some calls."""
    for function in _callbacks(code):
        body = function.body
        if not code.stands_alone(body[0]) or body[0].lineno == function.lineno:
            continue
        count = "globals().setdefault('_calls', [])"
        for number in _LATE:
            for end in ("raise RuntimeError('too late')", "return"):
                stops = f"\n{code.indentation(body[0])}if len({count}) > {number}: {end}"
                yield code.before(body[0], f"{count}.append(1){stops}")
        yield code.before(body[0], "__import__('time').sleep(2)")


def _callbacks(code: Code) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    callbacks = [callback for call in code.calls(*_CALLBACKS) if (callback := given(call, _CALLBACKS))]
    names = {code.source(callback).rpartition(".")[2] for callback in callbacks}
    return [function for function in code.functions() if function.name in names]


OPERATORS = (impatient, restless, taken_for_granted, hardly_spun, not_awaited, threads, answer, late)
