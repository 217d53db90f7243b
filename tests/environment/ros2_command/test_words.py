"""Words, help and exit codes. Nothing of this starts ROS."""

from __future__ import annotations

import sys

import pytest

from environment.ros2_command.commands import COMMANDS, ELSEWHERE
from environment.ros2_command.main import run

VERBS = [(command, verb) for command in COMMANDS for verb in COMMANDS[command].verbs]
ALONE = [command for command in COMMANDS if COMMANDS[command].itself]


@pytest.fixture(autouse=True)
def keep_stdout_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("environment.ros2_command.main._line_buffered", lambda: None)


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


def test_a_wrong_word_is_an_error_that_lists_the_right_ones(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topics") == 2
    assert "invalid choice: 'topics'" in capsys.readouterr().err
    assert exit_code("topic", "lst") == 2
    assert "invalid choice: 'lst'" in capsys.readouterr().err


def test_an_unknown_option_is_an_error_that_says_who_may_know_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topic", "list", "--pretty") == 2
    error = capsys.readouterr().err
    assert "unrecognized arguments: --pretty" in error
    assert "needs the full ros2cli" in error


def test_options_may_stand_before_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("topic", "--include-hidden-topics", "type", "-h") == 0
    assert "usage: ros2 topic type" in capsys.readouterr().out


def test_an_error_text_goes_to_stderr_with_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code("pkg", "prefix", "no_such_package") == 1
    assert capsys.readouterr().err == "Package not found\n"


def test_ctrl_c_ends_with_exit_code_2(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_argv: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("environment.ros2_command.main._dispatch", interrupted)
    assert run(["topic", "echo"]) == 2
