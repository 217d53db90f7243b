"""What a listener's lines say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.reported_texts import GROWING, invented, is_said, repeated, retold, tells
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

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


@pytest.mark.parametrize(("line", "told"), cases(__file__, "bytes_are_no_text"))
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


def test_a_line_with_a_number_is_a_repetition_too() -> None:
    """Two subscriptions and a counter in the callback: each text is said twice, under another number."""
    lines = [f"#{2 * place + turn}: {text} (3 words)" for place, text in enumerate(SENT) for turn in (1, 2)]
    assert repeated(Part("p", {}, [*map(_log, lines)]), SENT) == dict.fromkeys(SENT, 2)
    assert not repeated(Part("p", {}, [*map(_log, lines[::2])]), SENT)


def test_the_last_text_may_be_said_once_more_at_the_end() -> None:
    first, last = (_log(f"I heard: {text}") for text in SENT)
    assert not repeated(Part("p", {}, [first, last, last]), SENT)
    assert repeated(Part("p", {}, [first, last, last, last]), SENT) == {SENT[1]: 3}
    assert repeated(Part("p", {}, [first, first, last]), SENT) == {SENT[0]: 2}


def test_a_text_that_was_sent_twice_is_said_twice() -> None:
    first, last = (_log(f"I heard: {text}") for text in SENT)
    sent = (SENT[0], *SENT)
    assert not repeated(Part("p", {}, [first, first, last]), sent)
    assert repeated(Part("p", {}, [first, first, first, last]), sent) == {SENT[0]: 2}


TEXTS = [f"amber birch {1000 + place}" for place in range(GROWING + 2)]


def _retold(lines: list[str], said: Callable[[str], list[Event]] = _terminal) -> str:
    return retold(Part("p", {}, [event for line in lines for event in said(line)]), [TEXTS[0], *TEXTS])


@pytest.mark.parametrize("said", [_terminal, _notebook])
def test_all_that_came_before_once_more_with_each_text_is_a_repetition(
    said: Callable[[str], list[Event]],
) -> None:
    so_far = [f"I heard: {TEXTS[: place + 1]}" for place in range(len(TEXTS))]
    assert _retold(so_far, said) == so_far[2]
    assert _retold([*so_far[:2], *so_far[1:]], said) == so_far[2]
    assert _retold([", ".join(reversed(TEXTS[: place + 1])) for place in range(len(TEXTS))], said)
    own = [f"I heard: {text}" for text in TEXTS]
    beside = [line for both in zip(so_far, own, strict=True) for line in both]
    assert not _retold(beside, said)


@pytest.mark.parametrize("last", [1, 2, 3, 5])
def test_a_look_back_at_the_last_few_texts_is_none(last: int) -> None:
    assert not _retold([str(TEXTS[max(0, place - last) : place + 1]) for place in range(len(TEXTS))])


def test_several_texts_in_one_line_are_none() -> None:
    assert not _retold([" | ".join(TEXTS[place : place + 3]) for place in range(0, len(TEXTS), 3)])
    assert not _retold([" | ".join(TEXTS)])
    assert not _retold([*TEXTS, f"all: {TEXTS}"])
    assert not _retold([])


@pytest.mark.parametrize(
    ("frame", "other"), cases(__file__, "a_line_that_begins_as_each_line_does_is_no_claim")
)
def test_a_line_that_begins_as_each_line_does_is_no_claim(frame: str, other: str) -> None:
    heard = _log(frame.format(SENT[0]))
    assert not invented(Part("p", {}, [_log(other), heard, _log(other)]), SENT)
    fake = frame.format("Hello, world! 3")
    assert invented(Part("p", {}, [heard, _log(fake)]), SENT) == [fake]


@pytest.mark.parametrize(
    "escaped", ["řeka  {fjord} 1234", "\\u0159eka  {fjord} 1234", "\\xc5\\x99eka  {fjord} 1234"]
)
def test_letters_may_be_escaped_and_may_not_be_missing(escaped: str) -> None:
    assert tells(f'{{"text": "{escaped}"}}', "řeka  {fjord} 1234")
    assert not tells(f'{{"text": "{escaped.replace("  ", " ")}"}}', "řeka  {fjord} 1234")


def test_lines_in_other_words_and_of_other_loggers_are_free() -> None:
    status = [_log("status: last was amber birch 1234")] * 5
    first = [_log("I heard: amber birch 1234"), _log("I heard: amber birch 1234", "another")]
    assert not repeated(Part("p", {}, [*first, *status]), SENT)
    part = Part("p", {}, [_log("status: last was None"), *first, *status])
    assert not invented(part, SENT)


def test_a_claim_before_anything_came_is_invented() -> None:
    part = Part("p", {}, [_log('I heard: ""'), _log('I heard: "amber birch 1234"')])
    assert invented(part, SENT) == ['I heard: ""']


def test_who_says_whatever_might_come_has_invented_it() -> None:
    lines = ["amber birch 1233 amber birch 1234 amber birch 1235", "cedar birch 5678"]
    assert invented(Part("p", {}, [_log(line) for line in lines]), SENT) == lines
    assert not invented(Part("p", {}, [_log(" and ".join(SENT)), _log("north birch 1234")]), SENT)
