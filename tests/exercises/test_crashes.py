"""Tracebacks and the mistakes that they give away."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, meant, traceback_of
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Sequence


def _output(text: str) -> Event:
    return Event(1.0, "output", "stderr", {"text": text})


def _shown(lines: Sequence[str]) -> Evidence:
    shown = ["Traceback (most recent call last):", '  File "talker.py", line 3, in main', *lines]
    return Evidence(
        [Part("part", {}, [Event(0.1, "output", "stderr", {"text": t}) for t in shown])], Reference("x", {})
    )


@pytest.mark.parametrize(("lines", "key", "says"), cases(__file__, "what_a_traceback_shows"))
def test_what_a_traceback_shows(lines: tuple[str, ...], key: str, says: str) -> None:
    shown = _shown(lines)
    told = ((mistake.key, mistake.recognize(shown)) for mistake in (*CRASHES, *OTHER_CRASHES))
    found, text = next(((found, advice.text) for found, advice in told if advice), ("", ""))
    assert found == key
    assert re.search(says, text, re.DOTALL)
    assert not shown.main.said()


HEAD = 'Traceback (most recent call last):\n  File "client.py", line 9, in <module>\n    main()\n'


@pytest.mark.parametrize(("rest", "expected"), cases(__file__, "the_innermost_line_tells"))
def test_the_innermost_line_tells(rest: str, expected: bool) -> None:
    assert meant(HEAD + rest) is expected


@pytest.mark.parametrize(
    ("event", "told"),
    [
        (
            Event(1.0, "subject", "returned", {"value": "<coroutine object ask at 0x7f>"}),
            "ask is an `async def`",
        ),
        (_output("<generator object main at 0x7f>"), ""),
        (_output("sys:1: RuntimeWarning: coroutine 'main' was never awaited"), "main is an `async def`"),
        (_output("sys:1: RuntimeWarning: coroutine 'ActionServer._execute_goal' was never awaited"), ""),
        (_output("sys:1: RuntimeWarning: coroutine 'await_or_execute' was never awaited"), ""),
    ],
)
def test_a_function_that_only_makes_a_coroutine_is_named_and_no_callback_that_came_too_late(
    event: Event, told: str
) -> None:
    evidence = Evidence([Part("part", {}, [event])], Reference("x", {}))
    advice = next(filter(None, (m.recognize(evidence) for m in CRASHES)), None)
    assert (advice.text.startswith(told) and bool(told)) if advice else not told


def test_of_the_programs_of_a_launch_each_has_a_traceback_of_its_own() -> None:
    """Their lines come one between the other, behind the name that the launch has for the program."""
    head, frame = "Traceback (most recent call last):", '  File "talker.py", line 3, in main'
    lines = [
        head,
        frame,
        "    rclpy.init()",
        "RCLError: failed: Couldn't parse remap rule: '-r a:=/b/'. Error: not set",
    ]
    shown = [f"[{program}] {line}" for line in lines for program in ("talker-1", "listener-2")]
    evidence = Evidence([Part("part", {}, [_output(text) for text in shown])], Reference("x", {}))
    assert evidence.main.traceback == "\n".join(lines)
    advice = next(filter(None, (m.recognize(evidence) for m in (*CRASHES, *OTHER_CRASHES))))
    assert "Couldn't parse remap rule: '-r a:=/b/'" in advice.text


def test_nothing_is_meant_by_nothing() -> None:
    assert not meant("")


def test_the_traceback_of_a_launched_program_is_not_among_the_words_of_the_programs() -> None:
    lines = (
        "[talker-1] Traceback (most recent call last):",
        '[talker-1]   File "/ws/lib/my_robot_pkg/talker", line 33, in <module>',
        "[listener-2] I heard: Hello",
        "[talker-1]     raise ValueError(text)",
        "[talker-1] ValueError: I heard: nothing",
        "[talker-1] I go on",
    )
    part = Part("launching", events=[Event(0.0, "output", "stdout", {"text": line}) for line in lines])
    assert part.said() == ["[listener-2] I heard: Hello", "[talker-1] I go on"]


def test_a_traceback_that_was_cut_off_does_not_hide_a_whole_one_of_another_run() -> None:
    whole = 'Traceback (most recent call last):\n  File "server.py", line 3, in execute\nAttributeError: no'
    ends = (whole, "Traceback (most recent call last):")
    parts = [Part(text, {}, [Event(1.0, "subject", "raised", {"traceback": text})]) for text in ends]
    assert traceback_of(Evidence(parts, Reference("lab_9_1.server", {}))) == whole
    assert traceback_of(Evidence(parts[1:], Reference("lab_9_1.server", {}))) == ends[1]


def test_a_program_that_python_does_not_find_is_named() -> None:
    line = "/usr/bin/python3: can't open file '/home/me/talkr.py': [Errno 2] No such file or directory"
    events = [_output(line), Event(2.0, "subject", "exited", {"code": 2})]
    evidence = Evidence([Part("part", {}, events)], Reference("x", {}))
    advice = next(filter(None, (mistake.recognize(evidence) for mistake in CRASHES)))
    assert advice.text.startswith("Python does not find the program /home/me/talkr.py")


@pytest.mark.parametrize(("begun", "key"), [(False, "cut_off"), (True, "never_ended")])
def test_a_notebook_that_does_not_answer_is_told_from_a_constructor_that_never_returns(
    begun: bool, key: str
) -> None:
    started = [Event(0.0, "subject", "started", {"accepted": []})] if begun else []
    part = Part("part", {}, [*started, Event(10.0, "subject", "never_constructed", {})])
    evidence = Evidence(
        [Part("earlier", {}, [Event(0.5, "subject", "constructed", {})]), part], Reference("x", {})
    )
    ladder = (*CRASHES, unfinished.NEVER_CONSTRUCTED)
    assert [mistake.key for mistake in ladder if mistake.recognize(evidence)][:1] == [key]
