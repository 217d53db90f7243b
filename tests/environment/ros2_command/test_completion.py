"""Tab, as bash asks: words, options, types, and the names on the graph."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

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


@pytest.mark.parametrize(("line", "words"), cases(__file__, "what_is_installed_is_offered"))
def test_what_is_installed_is_offered(
    offered: Callable[[str], list[str]], line: str, words: tuple[str, ...]
) -> None:
    assert offered(line) == list(words)


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
