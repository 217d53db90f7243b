"""Which lines are the subject's own words: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part


def output(text: str) -> Event:
    return Event(0.0, "output", "stdout", {"text": text})


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (output("hello"), ["hello"]),
        (output("[INFO] [1763632000.5] [client]: 7"), ["7"]),
        (Event(0.0, "log", "client", {"text": "7"}), ["7"]),
        (Event(0.0, "log", "rclpy_student", {"text": "7"}), ["7"]),
        (output("2026-11-20: the goal was aborted"), ["2026-11-20: the goal was aborted"]),
        (Event(0.0, "log", "client.action_client", {"text": "Ignoring unexpected result response."}), []),
        (output("[WARN] [1763632000.5] [client.action_client]: Ignoring unexpected result response."), []),
        (output("[ERROR] [1763632000.5] [rcl]: Failed to publish log message to rosout"), []),
        (
            output("\x1b[37;1m2026-11-20 10:41:00.123 \x1b[31;1m[RTPS_HISTORY Error] \x1b[0mChange is full"),
            [],
        ),
        (
            output(
                "\x1b[37;1m2026-11-21 07:12:22.318 \x1b[31;1m[\x1b[37;1mRTPS_TRANSPORT_SHM\x1b[31;1m Error] "
                "\x1b[37mFailed init_port fastrtps_port7008: open_and_lock_file failed\x1b[34;1m -> Function "
                "\x1b[36mopen_port_internal\x1b[m"
            ),
            [],
        ),
        (output("@process left"), []),
    ],
)
def test_what_ros_itself_says_is_not_the_subjects_word(event: Event, words: list[str]) -> None:
    assert Part("part", {}, [event]).said() == words


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
