"""A hung program's stack, told apart."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.hangs import HANGS

RCLPY = "/venv/lib/python3.11/site-packages/rclpy"
WAIT = '  File "/usr/lib/python3.11/threading.py", line 320 in wait'


def _stack(*calls: tuple[str, str]) -> str:
    lines = [f'  File "{file}", line 7 in {function}' for file, function in calls]
    return "\n".join(["Thread 0x00007f (most recent call first):", WAIT, *lines])


CALL = (f"{RCLPY}/client.py", "call")
SPIN = (f"{RCLPY}/executors.py", "spin")
CALLBACK = (f"{RCLPY}/executors.py", "handler")
CALLS_BACK = (f"{RCLPY}/executors.py", "await_or_execute")
DONE = (f"{RCLPY}/task.py", "__call__")
OWN = ("/home/student/client.py", "work")

CASES = {
    "call_never_spun": [_stack(CALL, OWN)],
    "call_in_same_group": [_stack(CALL, OWN, CALLBACK, SPIN, OWN)],
    "nested_spin": [_stack((f"{RCLPY}/__init__.py", "spin_until_future_complete"), OWN, CALLBACK, SPIN, OWN)],
    "node_taken_from_executor": [_stack(CALL, OWN), _stack(SPIN)],
    "rate_never_spun": [_stack((f"{RCLPY}/timer.py", "sleep"), OWN)],
    "never_spun": [_stack(OWN)],
}
IN_CALLBACK = {
    "a loop": _stack(OWN, CALLS_BACK, CALLBACK, SPIN, OWN),
    "a helper of the callback": _stack(
        ("/home/student/help.py", "wait_long"), OWN, CALLS_BACK, CALLBACK, SPIN
    ),
    "a queue": _stack(("/usr/lib/python3.11/queue.py", "get"), OWN, CALLS_BACK, CALLBACK, SPIN),
    "a wait for a service": _stack(
        (f"{RCLPY}/client.py", "wait_for_service"), OWN, CALLS_BACK, CALLBACK, SPIN
    ),
    "a future's callback": _stack(OWN, DONE, SPIN),
}


@pytest.mark.parametrize("key", CASES)
def test_the_stack_names_the_hang(key: str) -> None:
    part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": "\n\n".join(CASES[key])})])
    evidence = Evidence([part], Reference("x", {}))
    found = next(mistake.key for mistake in HANGS if mistake.recognise(evidence))
    assert found == key


@pytest.mark.parametrize("where", IN_CALLBACK)
def test_a_callback_that_does_not_come_back_is_named(where: str) -> None:
    main = _stack(CALL, ("/home/student/client.py", "main"))  # beside it, the main thread waits for it
    for text in (IN_CALLBACK[where], f"{main}\n\n{IN_CALLBACK[where]}"):
        part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": text})])
        evidence = Evidence([part], Reference("x", {}))
        found = next(mistake for mistake in HANGS if mistake.recognise(evidence))
        advice = found.recognise(evidence)
        assert found.key == "callback_never_returns"
        assert advice is not None
        assert "work()" in advice.text


def test_no_stack_names_nothing() -> None:
    evidence = Evidence([Part("part")], Reference("x", {}))
    assert not any(mistake.recognise(evidence) for mistake in HANGS)
