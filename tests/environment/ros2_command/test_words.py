"""Words, help and exit codes. Nothing of this starts ROS."""

from __future__ import annotations

import re
import sys

import pytest

from course_runtime.ros2_command.commands import COMMANDS, ELSEWHERE
from course_runtime.ros2_command.main import run
from tests.cases import cases

VERBS = [(command, verb) for command in COMMANDS for verb in COMMANDS[command].verbs]
ALONE = [command for command in COMMANDS if COMMANDS[command].itself]


@pytest.fixture(autouse=True)
def keep_stdout_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_runtime.ros2_command.main._line_buffered", lambda: None)


def exit_code(*words: str) -> int:
    try:
        return run(list(words))
    except SystemExit as end:
        return int(end.code or 0)


@pytest.mark.parametrize(
    "words", [("-h",), (), ("--help",), *[(name,) for name in COMMANDS if name not in ALONE]]
)
def test_a_group_shows_its_words(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code(*words) == 0
    shown = capsys.readouterr().out
    command = COMMANDS.get(words[0] if words else "")
    for name in command.verbs if command else COMMANDS:
        assert f"\n  {name} " in shown


@pytest.mark.parametrize("words", [*VERBS, *[(name,) for name in ALONE]], ids=" ".join)
def test_every_word_has_help(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code(*words, "-h") == 0
    assert f"usage: ros2 {' '.join(words)} [-h]" in capsys.readouterr().out


def test_help_needs_no_ros() -> None:
    for words in [*VERBS, *[(name,) for name in ALONE]]:
        before = set(sys.modules)
        exit_code(*words, "-h")
        assert not {"rclpy", "numpy"} & (set(sys.modules) - before), words


@pytest.mark.parametrize(
    "words",
    [*[(name,) for name in ELSEWHERE], *[(c, v) for c in COMMANDS for v in sorted(COMMANDS[c].elsewhere)]],
    ids=" ".join,
)
def test_the_rest_of_ros2cli_is_named_as_such(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(*words, "some", "--more") == 2
    assert f"`ros2 {' '.join(words)}` needs the full ros2cli" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "meant"), cases(__file__, "a_wrong_word_is_an_error_that_names_the_right_one")
)
def test_a_wrong_word_is_an_error_that_names_the_right_one(
    words: tuple[str, ...], meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(*words) == 2
    first, *rest = capsys.readouterr().err.splitlines()
    assert f"the word '{words[-1]}' does not exist here. Did you mean `{meant}`?" in first
    assert rest[1].startswith("usage: ros2")


def test_an_unknown_option_is_an_error_that_says_who_may_know_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topic", "list", "--pretty") == 2
    first, second, *_ = capsys.readouterr().err.splitlines()
    assert first == "ros2 topic list: error: unknown option: --pretty"
    assert "any other needs the full ros2cli" in second


@pytest.mark.parametrize(
    ("words", "quoted"), cases(__file__, "a_value_that_the_shell_has_cut_says_first_that_it_needs_quotes")
)
def test_a_value_that_the_shell_has_cut_says_first_that_it_needs_quotes(
    words: tuple[str, ...], quoted: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(*words) == 2
    error = capsys.readouterr().err
    assert error.splitlines()[1] == f"Put a value with spaces into quotes: {quoted}"
    assert "full ros2cli" not in error


def test_a_word_too_many_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topic", "type", "/chatter", "please") == 2
    error = capsys.readouterr().err
    assert error.startswith("ros2 topic type: error: too many words: please\n")
    assert "quotes" not in error


@pytest.mark.ros
def test_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("--version") == 0
    assert re.fullmatch(
        r"ros2 of the course, for ROS 2 Jazzy \(rclpy 7\.\d+\.\d+\)\n", capsys.readouterr().out
    )


def test_options_may_stand_before_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topic", "--include-hidden-topics", "type", "-h") == 0
    assert "usage: ros2 topic type" in capsys.readouterr().out


def test_an_error_text_goes_to_stderr_with_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("pkg", "prefix", "no_such_package") == 1
    assert capsys.readouterr().err == "Package not found\n"


def test_ctrl_c_ends_with_exit_code_2(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_argv: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("course_runtime.ros2_command.main._dispatch", interrupted)
    assert run(["topic", "echo"]) == 2
