"""What one process may say to another that does not trust it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
from typing import get_args

import msgspec
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from autograder.messages import json_lines, judge_messages, run_messages, workspace_messages
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood, Silent, TooLong
from tests.cases import cases
from tests.drawn import drawn


def _pair() -> tuple[socket.socket, Lines]:
    here, there = socket.socketpair()
    return here, Lines(there)


def test_messages_come_one_by_one_however_they_are_cut() -> None:
    wire, judge = _pair()
    wire.sendall(b'{"say": "check", "exercise": "lab_1_2.talker"}\n{"say": "re')
    assert judge.hear(judge_messages.FromNotebook) == judge_messages.Check("lab_1_2.talker")
    wire.sendall(b'ady"}\n')
    assert judge.hear(judge_messages.FromNotebook) == run_messages.Ready()


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(b"hello\n", id="no JSON"),
        pytest.param(b"[1, 2]\n", id="no object"),
        pytest.param(b'{"exercise": "lab_1_2.talker"}\n', id="no word"),
        pytest.param(b'{"say": 7}\n', id="a number for a word"),
        pytest.param(b"\xff\xfe\n", id="no text"),
        pytest.param(b"[" * 100_000 + b"\n", id="too deep"),
        pytest.param(b"", id="nothing"),
    ],
)
def test_what_is_no_message_ends_the_conversation(line: bytes) -> None:
    wire, judge = _pair()
    wire.sendall(line)
    wire.close()
    with pytest.raises(Hangup):
        judge.hear(judge_messages.FromNotebook)


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(b'{"say": "open_all"}', id="an unknown word"),
        pytest.param(b'{"say": "begin", "domain": 1, "keeper": ""}', id="a word of the other side"),
        pytest.param(b'{"say": "returned"}', id="of no run"),
        pytest.param(b'{"say": "returned", "run": "1"}', id="a text for a number"),
        pytest.param(b'{"say": "output", "run": 1, "text": ["a"]}', id="a list for a text"),
        pytest.param(b'{"say": "source", "path": "a", "data": "?"}', id="no base64"),
        pytest.param(b'{"say": "source", "path": "a", "data": "\\ud800"}', id="half a character for base64"),
    ],
)
def test_what_is_not_expected_is_not_understood_and_ends_nothing(line: bytes) -> None:
    wire, judge = _pair()
    wire.sendall(line + b'\n{"say": "ready"}\n')
    with pytest.raises(NotUnderstood):
        judge.hear(judge_messages.FromNotebook)
    assert judge.hear(judge_messages.FromNotebook) == run_messages.Ready()


class Stubborn(str):
    """A text that a student has made, and that will not become another one."""

    def __str__(self) -> str:
        return self


TEXTS = st.text(st.characters(exclude_categories=()))


@drawn(200)
@given(TEXTS, st.integers(0, 2**53))
@example("\ud800 half a character", 1)
@example("\0", 1)
@example(Stubborn("stubborn"), 1)
def test_any_text_of_a_subject_s_arrives(text: str, run: int) -> None:
    wire, judge = _pair()
    with wire, contextlib.closing(judge):
        for message in (run_messages.Output(run, text), judge_messages.Check(text)):
            Lines(wire).say(message)
            assert judge.hear(judge_messages.FromNotebook) == message


def test_every_word_stands_for_one_message() -> None:
    for union in (
        judge_messages.FromNotebook,
        judge_messages.FromJudge,
        workspace_messages.ToService,
        workspace_messages.FromService,
        workspace_messages.BuildAnswer,
    ):
        words = [msgspec.inspect.type_info(kind).tag for kind in get_args(union)]  # type: ignore[attr-defined]
        assert len(set(words)) == len(words)


def test_an_endless_line_ends_the_conversation() -> None:
    wire, judge = _pair()
    flood = threading.Thread(target=_flood, args=(wire,), daemon=True)
    flood.start()
    with pytest.raises(Hangup, match="too long"):
        judge.hear(judge_messages.FromNotebook)
    judge.close()
    flood.join()


def _flood(wire: socket.socket) -> None:
    try:
        for _ in range(10):
            wire.sendall(b"x" * json_lines.MAX_LINE)
    except OSError:
        pass


def test_talking_to_nobody_is_noticed() -> None:
    wire, judge = _pair()
    wire.close()
    with pytest.raises(Hangup):
        _talk_on(judge)


def _talk_on(judge: Lines) -> None:
    # The first message may still go into the kernel's buffer.
    for _ in range(100):
        judge.say(judge_messages.Release(1))


def test_json_is_passed_on_as_it_came_and_waited_for_with_a_limit() -> None:
    wire, theirs = socket.socketpair()
    near = Lines(theirs, 100)
    wire.sendall(b'{"a": 1}\n')
    assert near.hear_json(10.0) == b'{"a": 1}'
    with pytest.raises(Silent):
        near.hear_json(0.01)
    wire.sendall(b"x" * 200)
    with pytest.raises(TooLong):
        near.hear_json(10.0)


def test_who_says_nothing_more_still_hears() -> None:
    ours, theirs = socket.socketpair()
    near, far = Lines(ours), Lines(theirs)
    near.finish()
    with pytest.raises(Hangup):
        far.hear_json(10.0)
    far.say_json(b"{}")
    assert near.hear_json(10.0) == b"{}"


CHILD = cases(__file__, "CHILD")


def test_a_child_of_a_process_does_not_hold_its_conversation_open() -> None:
    ours, its_own = socket.socketpair()
    with its_own:
        process = subprocess.Popen(
            [sys.executable, "-c", CHILD],
            stdin=its_own.fileno(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    near = Lines(ours)
    child = int(near.hear_json(60.0))
    try:
        process.kill()
        with pytest.raises(Hangup) as how:
            near.hear_json(60.0)
        assert not isinstance(how.value, Silent)
    finally:
        os.kill(child, signal.SIGKILL)
        process.wait()
