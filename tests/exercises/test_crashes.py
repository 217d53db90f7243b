"""Tracebacks and the mistakes that they give away."""

from __future__ import annotations

import pytest

from autograder.exercises.crashes import CRASHES, OTHER_CRASHES
from autograder.exercises.evidence import Event, Evidence, Part, Reference

LAST_LINES = {
    "init_twice": "RuntimeError: Context.init() must only be called once",
    "not_initialized": "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called",
    "super_init_missing": "AttributeError: 'TalkerNode' object has no attribute '_default_callback_group'",
    "node_attribute_overwritten": "AttributeError: property 'clients' of 'TalkerNode' object has no setter",
    "qos_arguments_swapped": "TypeError: Expected QoSProfile or int, but received <class 'method'>",
    "qos_depth_missing": "TypeError: Node.create_publisher() missing 1 required positional argument: 'qos_profile'",
    "timer_callback_called": "TypeError: 'NoneType' object is not callable",
    "field_typo": "AttributeError: 'String' object has no attribute 'dta'",
    "request_not_instantiated": "NotImplementedError: Service classes can not be instantiated",
    "result_read_too_early": "AttributeError: 'NoneType' object has no attribute 'sum'",
    "module_not_found": "ModuleNotFoundError: No module named 'my_robot_pkg'",
    "handle_overwritten": "TypeError: 'method' object does not support the context manager protocol",
    "builtin_callback": "ValueError: no signature found for builtin <built-in method append of list object>",
    "syntax_error": "SyntaxError: expected ':'",
    "crashed": "ZeroDivisionError: division by zero",
}


@pytest.mark.parametrize("key", LAST_LINES)
def test_the_traceback_names_the_mistake(key: str) -> None:
    lines = [
        "Traceback (most recent call last):",
        '  File "talker.py", line 3, in <module>',
        "    f()",
        LAST_LINES[key],
    ]
    events = [Event(0.1, "output", "stderr", {"text": line}) for line in lines]
    evidence = Evidence([Part("part", {}, events)], Reference("x", {}))
    found = next(m for m in (*CRASHES, *OTHER_CRASHES) if m.recognise(evidence))
    assert found.key == key
    advice = found.recognise(evidence)
    assert advice is not None
    assert "{" not in advice.text + advice.next_step


def test_saying_that_nobody_serves_is_no_crash() -> None:
    lines = [
        "Traceback (most recent call last):",
        '  File "c.py", line 3, in <module>',
        "TimeoutError: no service",
    ]
    events = [Event(0.1, "output", "stderr", {"text": line}) for line in lines]
    evidence = Evidence([Part("part", {}, events)], Reference("x", {}))
    assert not any(m.recognise(evidence) for m in (*CRASHES, *OTHER_CRASHES))
