"""Standard output: no line of Fast DDS stands among the results, and a long line is cut."""

from __future__ import annotations

import io
import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from autograder import check_journal
from autograder.authoring.answer_bank import Turn, judge_all
from autograder.cli import cli
from autograder.judge import command_check
from autograder.standard_output import short_lines, split_lines, stray_lines_on_stderr
from autograder.verdict import State, Verdict, to_json
from tests.cases import cases

LOG_LINE = b"2026-11-20 14:02:11.123 [RTPS_TRANSPORT_SHM Error] Failed to create segment\n"
"""A line as Fast DDS prints it."""

VERDICT = Verdict("lab_1_2.talker", "Talker", State.PASSED, 10.0, 10.0)


def _say_as_fast_dds() -> None:
    os.write(1, LOG_LINE)


def test_private_stdout_keeps_results_apart() -> None:
    program = f"""
import os
from autograder.standard_output import private_stdout
print("before")
results = private_stdout()
os.write(1, {LOG_LINE!r})
results.write(b"result")
results.flush()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert (done.stdout, done.stderr) == (b"before\nresult", LOG_LINE)


def test_stray_lines_go_to_stderr_only_in_the_meantime(capfd: pytest.CaptureFixture[str]) -> None:
    with stray_lines_on_stderr():
        _say_as_fast_dds()
    os.write(1, b"after")
    said = capfd.readouterr()
    assert (said.out, said.err) == ("after", LOG_LINE.decode())


class _Noisy:
    name = "noisy"

    def verdict(self, seed: str) -> bytes:
        _say_as_fast_dds()
        return to_json(VERDICT)


def test_a_judge_of_the_bank_leaves_stdout_to_the_verdicts(capfd: pytest.CaptureFixture[str]) -> None:
    judge_all(
        [Turn(_Noisy(), "seed")],
        jobs=1,
        done=lambda turn, verdict: print(turn.subject.name, verdict.score),
        failed=lambda _, trouble: print(trouble),
    )
    said = capfd.readouterr()
    assert said.out == "noisy 10.0\n"
    assert LOG_LINE.decode() in said.err


def test_check_prints_nothing_but_the_verdict(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def noisy(*_: object, **__: object) -> tuple[Verdict, None]:
        _say_as_fast_dds()
        return VERDICT, None

    monkeypatch.setattr(command_check, "check_and_keep", noisy)
    monkeypatch.setattr(check_journal, "note_check", lambda verdict: None)
    done = CliRunner().invoke(cli, ["check", "--json", VERDICT.exercise, "--", "true"])
    assert (done.exit_code, done.stdout) == (0, f"{to_json(VERDICT).decode()}\n")
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", LOG_LINE.decode())


def test_a_long_line_is_cut_and_the_next_one_is_whole() -> None:
    stream = io.BytesIO(b"first\n" + b"x" * 1_100_000 + b"\nlast\nno end")
    assert list(short_lines(stream, 100)) == [b"first\n", b"x" * 100, b"last\n", b"no end"]


def test_a_line_of_just_that_length_is_no_two_lines() -> None:
    assert list(short_lines(io.BytesIO(b"1234\n12345\n1\n"), 5)) == [b"1234\n", b"12345", b"1\n"]


def test_a_carriage_return_ends_a_line_before_the_next_newline_comes() -> None:
    waiting = [b"\rwaiting 1 s", b"\rwaiting 2 s", b"\r", b"\nthe sum is 3\r\n", b"\r\r\nend\r"]
    came: list[bytes] = []

    class Stream:
        def read1(self, _: int) -> bytes:
            came.append(b"(more)")
            return waiting.pop(0) if waiting else b""

    for line in short_lines(Stream(), 100):
        came.append(line)
    assert [line for line in came if line != b"(more)"] == [
        *(b"\r", b"waiting 1 s\r", b"waiting 2 s\r\n", b"the sum is 3\r\n"),
        *(b"\r", b"\r\n", b"end\r"),
    ]
    assert came.index(b"waiting 1 s\r") == 3  # with the second piece


def test_the_end_of_a_line_that_was_cut_is_seen_in_two_pieces() -> None:
    pieces = [b"12345", b"6\r", b"\n78\r", b"9\n", b""]
    stream = type("Stream", (), {"read1": lambda *_: pieces.pop(0)})()
    assert list(short_lines(stream, 5)) == [b"12345", b"78\r", b"9\n"]


@pytest.mark.parametrize(("text", "lines"), cases(__file__, "a_carriage_return_ends_a_line_too"))
def test_a_carriage_return_ends_a_line_too(text: str, lines: tuple[str, ...]) -> None:
    assert split_lines(text) == list(lines)
    assert split_lines(text.encode()) == [line.encode() for line in lines]
