"""What a listener's lines say."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.texts_said import invented, is_said, repeated, tells

SENT = ("amber birch 1234", "cedar delta 5678")


def _log(text: str, logger: str = "listener_node") -> Event:
    return Event(1.0, "log", logger, {"text": text, "level": 20})


def _output(text: str, stream: str = "stdout") -> Event:
    return Event(1.0, "output", stream, {"text": text})


def _terminal(text: str) -> list[Event]:
    """A log line as a judge of a command sees it: on /rosout, and with its prefix on standard output."""
    return [_log(text), _output(f"[INFO] [1795200851.98] [listener_node]: {text}")]


def _notebook(text: str) -> list[Event]:
    return [_log(text), _output(text, "notebook log")]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ('I heard: "amber birch 1234"', True),
        ("amber birch 1234", True),
        ("b'amber birch 1234'", True),
        ("b'\\x00\\x01\\x00\\x00\\x11\\x00\\x00\\x00amber birch 1234\\x00'", False),
        ("b'amber birch 1234\\x00'", False),
        ("\0\1\0\0\x11\0\0\0amber birch 1234\0", False),
        ("amber birch", False),
    ],
)
def test_bytes_are_no_text(line: str, told: bool) -> None:
    assert tells(line, SENT[0]) is told
    assert is_said(SENT[0], Part("p", {}, [_log(line)])) is told


@pytest.mark.parametrize("seen", [_terminal, _notebook])
def test_a_log_line_and_a_print_are_no_repetition(seen: object) -> None:
    said = _terminal if seen is _terminal else _notebook
    stream = "stdout" if seen is _terminal else "notebook"
    events = [e for text in SENT for e in (*said(f"I heard: {text}"), _output(f"I heard: {text}", stream))]
    assert not repeated(Part("p", {}, events), SENT)
    assert repeated(Part("p", {}, [*events, *events]), SENT) == dict.fromkeys(SENT, 2)


def test_one_text_twice_may_be_chance_and_thrice_is_not() -> None:
    line = _log("I heard: amber birch 1234")
    assert not repeated(Part("p", {}, [line] * 2), SENT)
    assert repeated(Part("p", {}, [line] * 3), SENT) == {SENT[0]: 3}


def test_lines_in_other_words_and_of_other_loggers_are_free() -> None:
    status = [_log("status: last was amber birch 1234")] * 5
    first = [_log("I heard: amber birch 1234"), _log("I heard: amber birch 1234", "another")]
    assert not repeated(Part("p", {}, [*first, *status]), SENT)
    part = Part("p", {}, [_log("status: last was None"), *first, *status])
    assert not invented(part, SENT)


def test_a_claim_before_anything_came_is_invented() -> None:
    part = Part("p", {}, [_log('I heard: ""'), _log('I heard: "amber birch 1234"')])
    assert invented(part, SENT) == ['I heard: ""']
