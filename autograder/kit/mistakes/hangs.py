"""Mistakes recognized from the stacks of a hung program: they show what each thread waits for.

The stacks come from Python's faulthandler, with the innermost call first. The judge requests them if a subject that
should still be running has fallen silent. In rclpy 7.1, ``Client.call`` waits in ``client.py``, the action client's
blocking calls in ``action/client.py``, and ``Rate.sleep`` in ``timer.py``. The calls in ``executors.py``, which calls
callbacks, come after the calls in the student's callback.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice, Mistake, card_words, filled_in

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part

_WORDS = card_words(__file__)

LOOPS = 2.0
"""Seconds of processor time in one callback after which it is in an endless loop, however busy the machine is."""
ENDLESS = "endless"
"""The name of the noted event about a goal for which the subject has sent far too much feedback."""
_LOOP = re2.compile(
    r" in the loop of line (?P<line>\d+): (?P<head>.*?)"
    r"(?P<never>(?P<endless>, whose condition stays true)|, which no line leaves)? \(most recent call first"
)
_FRAME = re2.compile(r'^\s*File "(?P<file>[^"]*)", line (?P<line>\d+),? in (?P<function>\S+)')
_BLOCKING = {
    "client.py": {"call"},
    "action/client.py": {"send_goal", "cancel_goal", "get_result", "_cancel_goal"},
}
_CALLS_BACK = {("executors.py", "await_or_execute"), ("task.py", "__call__")}
"""The functions of rclpy that run the callbacks of nodes and of futures, as (file, function)."""
_SPINS = {
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "_spin_once_impl",
    "spin_once_until_future_complete",
}


@dataclass(frozen=True)
class _StackFrame:
    """One call in a stack; ``rclpy`` is the file of rclpy that contains the call, and empty for other code."""

    rclpy: str
    function: str
    line: str = ""


Stack = Sequence[_StackFrame]


def _stacks(part: Part) -> list[Stack]:
    """Return the stacks of the subject's threads at the time when it hung, innermost call first."""
    return [stack for event in part.of("stack") for stack in _stacks_in(str(event.data["text"]))]


def _stacks_in(text: str) -> list[Stack]:
    found: list[list[_StackFrame]] = []
    for line in text.splitlines():
        if "most recent call first" in line:
            found.append([])
        elif (match := _FRAME.match(line)) and found:
            found[-1].append(_StackFrame(_rclpy_file(match["file"]), match["function"], match["line"]))
    return [stack for stack in found if stack]


def _rclpy_file(path: str) -> str:
    _, inside, rest = path.rpartition("/rclpy/")
    return rest if inside else ""


def _blocks(stack: Stack) -> bool:
    return any(frame.function in _BLOCKING.get(frame.rclpy, ()) for frame in stack)


def _in_callback(stack: Stack) -> bool:
    """Return True if the innermost code of the student in this stack runs in a callback."""
    return any(frame.rclpy == "executors.py" for frame in stack[_innermost_own(stack) :])


def _innermost_own(stack: Stack) -> int:
    """Return the index of the innermost call in the student's code; the length of the stack if there is none."""
    own = (i for i, frame in enumerate(stack) if not frame.rclpy and frame.function != "wait")
    return next(own, len(stack))


def _spins(stack: Stack) -> bool:
    return any(frame.rclpy in ("executors.py", "__init__.py") and frame.function in _SPINS for frame in stack)


def something_spins(part: Part) -> bool:
    """Return True if one of the subject's threads was spinning when the subject hung."""
    return any(map(_spins, _stacks(part)))


def _spins_in_callback(stack: Stack) -> bool:
    """Return True if an executor called the student's code, and that code called a spin."""
    spins = [i for i, frame in enumerate(stack) if frame.rclpy and frame.function in _SPINS]
    if not spins:
        return False
    own = next((i for i in range(spins[0], len(stack)) if not stack[i].rclpy), len(stack))
    return any(frame.rclpy == "executors.py" for frame in stack[own:])


def _sleeps_on_rate(stack: Stack) -> bool:
    return any(frame.rclpy == "timer.py" and frame.function == "sleep" for frame in stack)


def _stuck_callback(found: list[Stack]) -> str:
    """Return the name of the student's callback that has not returned; empty if there is none."""
    for stack in found:
        for frame, caller in reversed(list(pairwise(stack))):
            if not frame.rclpy and (caller.rclpy, caller.function) in _CALLS_BACK:
                return frame.function
    return ""


def _that(found: list[Stack], waits: Callable[[Stack], bool]) -> Stack:
    """Return a stack for which ``waits`` returns True, preferably of a callback; empty if there is none."""
    waiting = sorted(filter(waits, found), key=_in_callback, reverse=True)
    return waiting[0] if waiting else ()


def _waiting(stack: Stack) -> str:
    """Return the name of the blocking rclpy method that the student called in this stack; empty if there is none."""
    calls = [frame.function for frame in stack if frame.function in _BLOCKING.get(frame.rclpy, ())]
    return calls[-1] if calls else ""


def _place(stack: Stack) -> str:
    """Return the line of the student's code that waits, in parentheses; empty if there is none."""
    own = stack[_innermost_own(stack) :]
    return f" (line {own[0].line}, in {own[0].function})" if own else ""


def _loop_in(texts: Sequence[str]) -> str:
    """Return a sentence that quotes the loop in the texts of stacks; empty if there is none."""
    loops = filter(None, map(_LOOP.search, texts))
    found = (
        f" It is in the loop of line {one['line']}: `{one['head']}`{one['never'] or ''}." for one in loops
    )
    return next(found, "")


def _line_of(callback: str, found: list[Stack]) -> str:
    """Return a sentence with the line at which the student's callback was; empty if there is no callback."""
    frames = (frame for stack in found for frame in stack if not frame.rclpy and frame.function == callback)
    return next((f" It is at line {frame.line}." for frame in frames), "")


def _executes_a_goal(stack: Stack) -> bool:
    """Return True if an action server called the student's code to execute a goal."""
    return bool(_stuck_callback([stack])) and any(frame.rclpy == "action/server.py" for frame in stack)


def answered(part: Part) -> bool:
    """Return True if the subject answered a request or a goal, which only a callback of a node that is spun does."""
    return any(map(part.of, ("answered", "goal_answer", "cancel_answer")))


Recognize = Callable[[list[Stack]], bool]
UNSPUN = "never_spun"
"""The key of a node whose callbacks are never called."""
WAITS_FOR_ITSELF = ("nested_spin", "call_in_same_group")
"""Hangs that no time can end. In the others, the subject may be busy with something that comes to an end."""

_HANGS: tuple[tuple[str, Recognize, str, str], ...] = (
    ("nested_spin", lambda found: any(map(_spins_in_callback, found)), *_WORDS["nested_spin"]),
    (
        "call_in_same_group",
        lambda found: any(_blocks(stack) and _in_callback(stack) for stack in found),
        *_WORDS["call_in_same_group"],
    ),
    ("rate_never_spun", lambda found: any(map(_sleeps_on_rate, found)), *_WORDS["rate_never_spun"]),
    (
        "callback_never_returns",
        lambda found: any(map(_executes_a_goal, found)),
        *_WORDS["goal_never_returns"],
    ),
    ("callback_never_returns", lambda found: bool(_stuck_callback(found)), *_WORDS["callback_never_returns"]),
    (
        "node_taken_from_executor",
        lambda found: (
            any(map(_blocks, found)) and any(_spins(stack) and not _blocks(stack) for stack in found)
        ),
        *_WORDS["node_taken_from_executor"],
    ),
    ("call_never_spun", lambda found: any(map(_blocks, found)), *_WORDS["call_never_spun"]),
    (
        UNSPUN,
        lambda found: bool(found) and not any(frame.rclpy for stack in found for frame in stack),
        *_WORDS["never_spun"],
    ),
)


def _mistake(key: str, fits: Recognize, text: str, next_step: str) -> Mistake:
    def recognize(evidence: Evidence) -> Advice | None:
        found = [stack for part in evidence for stack in _stacks(part)]
        if not found or not fits(found) or (key == UNSPUN and any(map(answered, evidence))):
            return None
        if key == "call_in_same_group" and _may_come_back(evidence, found):
            return None
        texts = [str(event.data["text"]) for part in evidence for event in part.of("stack")]
        blocked = _that(found, _blocks)
        callback = _stuck_callback([blocked]) or _stuck_callback(found)
        words = {
            "callback": callback,
            "who": f"Your callback {callback}()" if callback else "A callback of yours",
            "call": _waiting(blocked),
            "called": _place(blocked),
            "slept": _place(_that(found, _sleeps_on_rate)),
            "stays": _loop_in(texts) or _line_of(callback, found),
        }
        return Advice(text.format(**words), next_step.format(**words))

    return Mistake(key, recognize, certain=key in WAITS_FOR_ITSELF)


def _may_come_back(evidence: Evidence, found: list[Stack]) -> bool:
    """Return True if a call waits for a late answer of the judge, and another thread can take it.

    While the callback waits, simulated time cannot go on, so the answer comes only in a look in real time.
    """
    owes = any(len(part.of("request")) > len(part.of("response")) for part in evidence)
    return owes and not evidence.real_time and not any(_blocks(stack) and _spins(stack) for stack in found)


def _never_leaves(thread: str) -> bool:
    """Return True if a thread is in a loop without an end.

    A `while True` may be all that a node does, in its main thread or in a timer's callback. But a goal has to end.
    """
    loop = _LOOP.search(thread)
    if loop is None or not loop["never"]:
        return False
    return bool(loop["endless"]) or any(map(_executes_a_goal, _stacks_in(thread)))


def _endless_loop(evidence: Evidence) -> Advice | None:
    told = [event.data for part in evidence for event in part.of("noted", ENDLESS)]
    shown = [event.data for part in evidence for event in part.of("stack")]
    busy = [data for data in shown if data.get("busy", 0.0) >= LOOPS]
    texts = [data["text"] for data in busy or shown]
    how = [f"to one goal it has sent {data['feedback']} feedback messages, and goes on" for data in told]
    how += [f"it has used the processor for {data['busy']:.0f} seconds, and goes on" for data in busy]
    threads = [thread for text in texts for thread in text.split("\nThread ")]
    how += ["nothing in its loop ends it" for _ in filter(_never_leaves, threads)]
    if not how:
        return None
    callback = _stuck_callback([stack for text in texts for stack in _stacks_in(text)])
    what = f"Your callback {callback}()" if callback else "Your code"
    return filled_in(_WORDS["endless_loop"], what=what, how=how, loop=_loop_in(texts))


ENDLESS_LOOP = Mistake("endless_loop", _endless_loop, certain=True)
"""A loop without an end: processor time or a number of messages proves it, however busy the machine is."""
HANGS: tuple[Mistake, ...] = tuple(_mistake(*row) for row in _HANGS)
"""The mistakes that a stack shows, most specific first."""
