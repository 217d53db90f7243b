"""Which lines are the subject's own words: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from tests.cases import cases


def output(text: str) -> Event:
    return Event(0.0, "output", "stdout", {"text": text})


@pytest.mark.parametrize(
    ("kind", "name", "text", "words"), cases(__file__, "what_ros_itself_says_is_not_the_subjects_word")
)
def test_what_ros_itself_says_is_not_the_subjects_word(
    kind: str, name: str, text: str, words: tuple[str, ...]
) -> None:
    assert Part("part", {}, [Event(0.0, kind, name, {"text": text})]).said() == list(words)


def test_what_logging_says_of_a_line_that_it_could_not_log_is_not_the_subjects_word() -> None:
    failed = (
        "--- Logging error ---",
        "Traceback (most recent call last):",
        '  File "/usr/lib/python3.12/logging/__init__.py", line 1110, in emit',
        "    msg = self.format(record)",
        "TypeError: not all arguments converted during string formatting",
        "Call stack:",
        '  File "mine.py", line 9, in <module>',
        "    main()",
        "Message: 'I heard: a text'",
        "Arguments: ('listener',)",
    )
    own = ("Message: my own", "I heard: a text", "Arguments: my own")
    part = Part("run", {}, [output(line) for line in (own[0], *failed, *own[1:])])
    assert [line for line in part.said() if line != failed[0]] == list(own)


def test_lines_of_one_stream_may_come_between_those_of_the_other() -> None:
    lines = [
        ("stderr", "Traceback (most recent call last):"),
        ("stdout", "before"),
        ("stderr", '  File "talker.py", line 2, in <module>'),
        ("stderr", "ValueError: Goal was canceled"),
    ]
    events = tuple(Event(float(at), "output", name, {"text": text}) for at, (name, text) in enumerate(lines))
    part = Part("part", {}, events)
    assert part.said() == ["before"]
    assert part.traceback.endswith("ValueError: Goal was canceled")
