"""`ros2 run` and the verbs about packages."""

from __future__ import annotations

import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Running

    Ros2 = Callable[..., subprocess.CompletedProcess[str]]


def test_the_program_gets_its_arguments(ros2: Ros2) -> None:
    done = ros2("run", "demo_pkg", "says", "0", "--flag", "x y", "--ros-args", "-r", "a:=b")
    assert done.stdout == "0 --flag x y --ros-args -r a:=b\n"
    assert done.stderr == "on stderr\n"
    assert done.returncode == 0


def test_the_exit_code_of_the_program_is_the_exit_code(ros2: Ros2) -> None:
    done = ros2("run", "demo_pkg", "says", "3")
    assert done.stdout.splitlines()[-1] == "[ros2run]: Process exited with failure 3"
    assert done.returncode == 3


@pytest.mark.parametrize(("words", "error"), cases(__file__, "what_is_not_there_is_named"))
def test_what_is_not_there_is_named(words: tuple[str, ...], error: str, ros2: Ros2) -> None:
    done = ros2("run", *words)
    assert (done.stderr, done.returncode) == (error, 1)


def test_a_workspace_that_is_not_sourced_is_not_found(ros2: Ros2) -> None:
    assert ros2("run", "demo_pkg", "says", AMENT_PREFIX_PATH="").returncode == 1


def test_a_prefix_goes_before_the_program(ros2: Ros2) -> None:
    done = ros2("run", "--prefix", "env MARK=yes", "demo_pkg", "says", "hello")
    assert done.stdout == "hello\n"


@pytest.mark.ros
def test_sigterm_ends_the_program_too(start: Callable[..., Running]) -> None:
    running = start("run", "demo_pkg", "talker")
    running.wait_for("said Hello 2")
    running.send(signal.SIGTERM)
    running.end()
    # The output has come to its end: the program, which held the pipe too, is gone.
    assert not running._reader.is_alive()


CTRL_C_AT_THE_START = cases(__file__, "CTRL_C_AT_THE_START")


def test_ctrl_c_is_left_to_the_program_from_its_start_on(env: dict[str, str]) -> None:
    command = [sys.executable, "-c", CTRL_C_AT_THE_START]
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    assert (done.stdout, done.stderr, done.returncode) == ("0\n", "on stderr\n", 0)


def test_packages_and_their_programs(ros2: Ros2, prefix: Path) -> None:
    names = ros2("pkg", "list").stdout.splitlines()
    assert "demo_pkg" in names
    assert names == sorted(names)
    assert ros2("pkg", "executables", "demo_pkg").stdout == (
        "demo_pkg listener\ndemo_pkg says\ndemo_pkg servers\ndemo_pkg talker\n"
    )
    paths = ros2("pkg", "executables", "demo_pkg", "--full-path").stdout.splitlines()
    assert paths[0] == f"{prefix}/lib/demo_pkg/listener"
    assert ros2("pkg", "executables", "no_such_pkg").stderr == "Package 'no_such_pkg' not found\n"
    assert ros2("pkg", "prefix", "demo_pkg").stdout == f"{prefix}\n"
    assert ros2("pkg", "prefix", "--share", "demo_pkg").stdout == f"{prefix}/share/demo_pkg\n"
