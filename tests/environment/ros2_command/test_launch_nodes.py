"""The same launch file in Python, XML and YAML, with real nodes: remapping, namespace and parameters."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Running

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

FILES = cases(__file__, "FILES")


@pytest.mark.parametrize("kind", FILES)
def test_nodes_with_remapping_namespace_and_parameters(
    kind: str,
    start: Callable[..., Running],
    ros2: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path: Path,
) -> None:
    path = tmp_path / f"talk.launch.{kind}"
    path.write_text(FILES[kind])
    running = start("launch", str(path), "words:=Good evening")
    assert "[listener-2]" in running.wait_for("heard Good evening")
    assert "[talker-1]" in running.wait_for("[room.anchor]: said Good evening")
    assert ros2("node", "list").stdout == "/room/anchor\n/room/left/listener\n"
    assert ros2("topic", "list").stdout.splitlines()[-1] == "/rosout"
    assert "/room/news" in ros2("topic", "list").stdout
    assert "chatter" not in ros2("topic", "list").stdout
    running.send(signal.SIGINT)
    assert running.end() == 0
    assert "process has finished cleanly" in running.text
    assert ros2("node", "list").stdout == ""


def test_a_file_of_parameters_and_a_nested_one(start: Callable[..., Running], tmp_path: Path) -> None:
    (tmp_path / "words.yaml").write_text("/**:\n  ros__parameters:\n    words: From a file\n")
    (tmp_path / "p.launch.xml").write_text(
        '<launch><node pkg="demo_pkg" exec="talker" output="screen">'
        '<param from="$(dirname)/words.yaml"/>'
        '<param name="qos_overrides"><param name="depth" value="3"/></param></node></launch>'
    )
    running = start("launch", str(tmp_path / "p.launch.xml"))
    running.wait_for("said From a file")


def test_an_unremapped_listener_hears_nothing(start: Callable[..., Running], tmp_path: Path) -> None:
    # The text's exercise 1.1 says that the listener follows by itself. It does not.
    path = tmp_path / "half.launch.xml"
    path.write_text(FILES["xml"].replace('to="/room/$(var topic)"', 'to="/room/chatter"'))
    running = start("launch", str(path))
    running.wait_for("[listener-2] [INFO]")
    running.wait_for("said Good day 20")
    assert "heard" not in running.text
