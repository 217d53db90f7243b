"""A hung program's stack, told apart."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mistakes.hangs import ENDLESS, ENDLESS_LOOP, HANGS, LOOPS
from autograder.own_lines import ENDLESS as ENDLESS_LOOPS
from autograder.own_lines import UNLEFT

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


def test_a_blocking_call_beside_a_thread_that_spins_has_lost_its_node() -> None:
    stacks = f"{_stack(CALL, OWN)}\n\n{_stack(SPIN)}"
    part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": stacks})])
    evidence = Evidence([part], Reference("x", {}))
    assert next(m.key for m in HANGS if m.recognize(evidence)) == "node_taken_from_executor"


@pytest.mark.parametrize(
    ("events", "real_time", "threads", "is_proof"),
    [
        (["request"], False, [], True),
        (["request"], False, [SPIN], False),
        (["request", "response"], False, [SPIN], True),
        (["request"], True, [SPIN], True),
    ],
    ids=["one thread", "another thread spins", "answered", "in real time"],
)
def test_a_call_that_another_thread_can_end_is_no_proof_before_its_answer(
    events: list[str], real_time: bool, threads: list[tuple[str, str]], is_proof: bool
) -> None:
    """In simulated time, a late answer never comes to a callback that holds up the time until it comes."""
    own = _stack(CALL, OWN, CALLS_BACK, CALLBACK, *([] if threads else [SPIN]))
    text = "\n\n".join([own, *map(_stack, threads)])
    seen = [*(Event(7.0, kind, "/lamp") for kind in events), Event(9.0, "stack", "subject", {"text": text})]
    evidence = Evidence([Part("part", {}, seen)], Reference("x", {}), real_time)
    found = next(mistake for mistake in HANGS if mistake.recognize(evidence))
    assert (found.key == "call_in_same_group") is is_proof
    assert found.certain is is_proof


@pytest.mark.parametrize("where", IN_CALLBACK)
def test_a_callback_that_does_not_come_back_is_named(where: str) -> None:
    main = _stack(CALL, ("/home/student/client.py", "main"))  # beside it, the main thread waits for it
    for text in (IN_CALLBACK[where], f"{main}\n\n{IN_CALLBACK[where]}"):
        part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": text})])
        evidence = Evidence([part], Reference("x", {}))
        found = next(mistake for mistake in HANGS if mistake.recognize(evidence))
        advice = found.recognize(evidence)
        assert found.key == "callback_never_returns"
        assert advice is not None
        assert "work()" in advice.text
        assert "It is at line 7." in advice.text


def test_a_callback_that_sleeps_in_a_loop_has_this_loop_quoted() -> None:
    found = next(filter(None, (mistake.recognize(_shown(IN_A_LOOP, 0.0)) for mistake in HANGS)))
    assert "It is in the loop of line 12: `while left > 0.0:`." in found.text


def test_call_line_and_callback_are_those_of_one_thread() -> None:
    """Two threads wait: the one in a callback is told, and nothing of the other one."""
    asks = _stack((f"{RCLPY}/action/client.py", "send_goal"), ("/home/student/client.py", "asks"))
    text = f"{asks}\n\n{_stack(CALL, OWN, CALLS_BACK, CALLBACK, SPIN)}"
    part = Part("part", {}, [Event(9.0, "stack", "subject", {"text": text})])
    evidence = Evidence([part], Reference("x", {}))
    advice = next(filter(None, (mistake.recognize(evidence) for mistake in HANGS)))
    assert "Your callback work() makes the blocking call call() (line 7, in work)" in advice.text


def test_no_stack_names_nothing() -> None:
    evidence = Evidence([Part("part")], Reference("x", {}))
    assert not any(mistake.recognize(evidence) for mistake in HANGS)


IN_A_LOOP = IN_CALLBACK["a loop"].replace(
    "Thread 0x00007f (", "Thread ros-spin in the loop of line 12: while left > 0.0: ("
)


def _shown(text: str, busy: float, *more: Event) -> Evidence:
    stack = Event(9.0, "stack", "subject", {"text": text, "busy": busy})
    return Evidence([Part("part", {}, [*more, stack])], Reference("x", {}))


def test_a_callback_that_uses_the_processor_is_in_a_loop_and_the_loop_is_quoted() -> None:
    advice = ENDLESS_LOOP.recognize(_shown(IN_A_LOOP, LOOPS))
    assert advice is not None
    assert "Your callback work() does not come to an end" in advice.text
    assert "It is in the loop of line 12: `while left > 0.0:`." in advice.text
    assert ENDLESS_LOOP.certain


def test_a_callback_that_sleeps_or_waits_for_the_processor_is_in_no_proven_loop() -> None:
    assert ENDLESS_LOOP.recognize(_shown(IN_A_LOOP, LOOPS / 2)) is None


def test_a_callback_that_sleeps_in_a_loop_that_cannot_end_is_in_a_loop() -> None:
    endless = IN_A_LOOP.replace("0.0: (", f"0.0:{ENDLESS_LOOPS} (")
    advice = ENDLESS_LOOP.recognize(_shown(endless, 0.0))
    assert advice is not None
    assert "It is in the loop of line 12: `while left > 0.0:`, whose condition stays true." in advice.text


def test_a_goal_with_far_too_much_feedback_is_in_a_loop() -> None:
    noted = Event(8.0, "noted", ENDLESS, {"feedback": 19})
    advice = ENDLESS_LOOP.recognize(_shown(IN_A_LOOP, 0.0, noted))
    assert advice is not None
    assert (
        "Your callback work() does not come to an end: to one goal it has sent 19 feedback messages"
        in advice.text
    )


@pytest.mark.parametrize(
    ("goal", "beside", "proven"), [(True, False, True), (False, False, False), (True, True, False)]
)
def test_a_loop_that_no_line_leaves_is_a_mistake_only_while_it_executes_a_goal(
    goal: bool, beside: bool, proven: bool
) -> None:
    execute = (f"{RCLPY}/action/server.py", "_execute_goal")
    text = _stack(OWN, CALLS_BACK, *([execute] if goal else []), SPIN)
    looping = _stack(OWN) if beside else text
    looping = looping.replace("7f (", f"7f in the loop of line 12: while True:{UNLEFT} (")
    shown = f"{text}\n{looping}" if beside else looping
    assert (ENDLESS_LOOP.recognize(_shown(shown, 0.0)) is not None) is proven


@pytest.mark.parametrize("kind", ["answered", "goal_answer", "cancel_answer"])
def test_a_node_whose_callback_was_called_is_spun_whatever_its_threads_do(kind: str) -> None:
    hung = Event(9.0, "stack", "subject", {"text": _stack(OWN)})
    for before, key in (([], "never_spun"), ([Event(1.0, kind, "/dock", {"accepted": True})], "")):
        evidence = Evidence([Part("part", {}, [*before, hung])], Reference("x", {}))
        assert next((one.key for one in HANGS if one.recognize(evidence)), "") == key
