"""A hung program's stack, told apart."""

from __future__ import annotations

import pytest

from autograder.exercises.evidence import Event, Evidence, Part, Reference
from autograder.exercises.hangs import HANGS

RCLPY = "/venv/lib/python3.11/site-packages/rclpy"
WAIT = '  File "/usr/lib/python3.11/threading.py", line 320 in wait'


def _stack(*calls: tuple[str, str]) -> str:
    lines = [f'  File "{file}", line 7 in {function}' for file, function in calls]
    return "\n".join(["Thread 0x00007f (most recent call first):", WAIT, *lines])


CALL = (f"{RCLPY}/client.py", "call")
SPIN = (f"{RCLPY}/executors.py", "spin")
CALLBACK = (f"{RCLPY}/executors.py", "handler")
OWN = ("/home/student/client.py", "work")

CASES = {
    "call_never_spun": [_stack(CALL, OWN)],
    "call_in_same_group": [_stack(CALL, OWN, CALLBACK, SPIN, OWN)],
    "nested_spin": [_stack((f"{RCLPY}/__init__.py", "spin_until_future_complete"), OWN, CALLBACK, SPIN, OWN)],
    "node_taken_from_executor": [_stack(CALL, OWN), _stack(SPIN)],
    "rate_never_spun": [_stack((f"{RCLPY}/timer.py", "sleep"), OWN)],
    "never_spun": [_stack(OWN)],
}


@pytest.mark.parametrize("key", CASES)
def test_the_stack_names_the_hang(key: str) -> None:
    part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": "\n\n".join(CASES[key])})])
    evidence = Evidence([part], Reference("x", {}))
    found = next(mistake.key for mistake in HANGS if mistake.recognise(evidence))
    assert found == key


def test_no_stack_names_nothing() -> None:
    evidence = Evidence([Part("part")], Reference("x", {}))
    assert not any(mistake.recognise(evidence) for mistake in HANGS)
