"""Tab, as bash asks: words, options, types, and the names on the graph."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from conftest import Running

pytest.importorskip("argcomplete")

# As argcomplete's function for bash asks: the answer is on descriptor 8.
ASK = (
    'COMP_LINE="$1" COMP_POINT=${#1} COMP_TYPE=9 _ARGCOMPLETE=1 _ARGCOMPLETE_SHELL=bash "$0" '
    "-m course_runtime.ros2_command 8>&1 9>&2 1>/dev/null"
)


@pytest.fixture
def offered(env: dict[str, str]) -> Callable[[str], list[str]]:
    """What Tab offers behind what is typed."""

    def ask(line: str) -> list[str]:
        command = ["bash", "-c", ASK, sys.executable, line]
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
        assert "Traceback" not in done.stderr
        return [word.strip() for word in done.stdout.split("\v")]

    return ask


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("ros2 ser", ["service"]),
        ("ros2 topic e", ["echo"]),
        ("ros2 topic echo --on", ["--once"]),
        ("ros2 interface show my_robot_interfaces/srv/Add", ["my_robot_interfaces/srv/AddTwoInts"]),
        ("ros2 service call /x my_robot_interfaces/srv/A", ["my_robot_interfaces/srv/AddTwoInts"]),
        ("ros2 run demo_", ["demo_pkg"]),
        ("ros2 run demo_pkg tal", ["talker"]),
        ("ros2 run no_such_pkg tal", [""]),
    ],
)
def test_what_is_installed_is_offered(
    offered: Callable[[str], list[str]], line: str, words: list[str]
) -> None:
    assert offered(line) == words


@pytest.mark.ros
def test_what_is_on_the_graph_is_offered(
    offered: Callable[[str], list[str]], start: Callable[..., Running]
) -> None:
    talker, servers = start("talker", program=True), start("servers", program=True)
    talker.wait_for("said")
    servers.wait_for("ready")
    assert offered("ros2 topic echo /ch") == ["/chatter"]
    assert offered("ros2 service call /add") == ["/add_two_ints"]
    assert offered("ros2 action send_goal /") == ["/fibonacci"]
    assert offered("ros2 node info /t") == ["/talker"]
    assert offered("ros2 param get /talker wo") == ["words"]
