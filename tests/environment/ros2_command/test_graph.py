"""The verbs against real nodes."""

from __future__ import annotations

import re
import shlex
import signal
import time
from typing import TYPE_CHECKING, Any

import pytest
import yaml

from tests.cases import cases, named_cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from conftest import Running

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros


class Call:
    """`ros2`, with the exit code checked."""

    def __init__(self, ros2: Callable[..., subprocess.CompletedProcess[str]]) -> None:
        self._ros2 = ros2

    def __call__(self, *words: str, code: int = 0) -> str:
        done = self._ros2(*words)
        assert done.returncode == code, done.stderr
        return done.stdout if code == 0 else done.stderr


@pytest.fixture
def call(ros2: Callable[..., subprocess.CompletedProcess[str]]) -> Call:
    return Call(ros2)


@pytest.fixture
def talker(start: Callable[..., Running]) -> Iterator[Running]:
    running = start("talker", program=True)
    running.wait_for("said")
    yield running
    running.kill()


@pytest.fixture
def servers(start: Callable[..., Running]) -> Iterator[Running]:
    running = start("servers", program=True)
    running.wait_for("ready")
    yield running
    running.kill()


def test_what_a_destroyed_node_leaves_behind_is_not_waited_for(start: Callable[..., Running]) -> None:
    """As long as its context lives there is a service of it, and its node's name is never told."""
    running = start("../destroyed_node", program=True)
    running.wait_for("settled")
    running.kill()


READY = {"talker": "said", "servers": "ready"}
"""What a program says when it can be asked."""


@pytest.mark.parametrize("scene", named_cases(__file__, "what_the_verbs_say"))
def test_what_the_verbs_say(
    scene: dict[str, Any],
    start: Callable[..., Running],
    ros2: Callable[..., subprocess.CompletedProcess[str]],
) -> None:
    started = [start(name, program=True) for name in scene["started"]]
    for running, name in zip(started, scene["started"], strict=True):
        running.wait_for(READY[name])
    for ask in scene["asks"]:
        done = ros2(*shlex.split(ask["ros2"]))
        said = done.stderr if ask.get("code") or "warns" in ask else done.stdout
        assert done.returncode == ask.get("code", 0), f"{ask['ros2']}: {done.stderr}"
        assert said == ask.get("says", said), ask["ros2"]
        assert re.fullmatch(ask.get("like", "(?s:.*)"), said), f"{ask['ros2']}: {said}"
        assert [text for text in (*ask.get("has", ()), ask.get("warns", "")) if text not in said] == []
        for running in started if "then" in ask else []:
            running.wait_for(ask["then"])


def test_ctrl_c_ends_echo(talker: Running, start: Callable[..., Running]) -> None:
    echo = start("topic", "echo", "/chatter")
    echo.wait_for("data: Hello")
    echo.send(signal.SIGINT)
    assert echo.end() == 2
    assert "Traceback" not in echo.text


def test_hz_measures_the_rate(talker: Running, start: Callable[..., Running]) -> None:
    hz = start("topic", "hz", "/chatter")
    rate = float(hz.wait_for("average rate: ").split()[-1])
    hz.wait_for("std dev: ")
    figures = r"\tmin: (\d\.\d{3})s max: (\d\.\d{3})s std dev: \d\.\d{5}s window: \d+"
    told = re.fullmatch(figures, hz.lines[1])
    assert told
    shortest, longest = map(float, told.groups())
    assert shortest * rate < 1.01
    assert longest * rate > 0.99
    assert 1.0 < rate < 13.0, "ten a second, of which a busy talker leaves some out"


def test_bw_measures_bytes(talker: Running, start: Callable[..., Running]) -> None:
    bw = start("topic", "bw", "/chatter")
    bw.wait_for("B/s from ")
    bw.wait_for("Message size mean: ")
    assert bw.lines[0] == "Subscribed to [/chatter]"
    assert re.fullmatch(r"\d+ B/s from \d+ messages", bw.lines[1])
    assert re.fullmatch(r"\tMessage size mean: (\d+) B min: \d+ B max: \d+ B", bw.lines[2])


def test_delay_is_the_age_of_a_message_and_needs_a_header(start: Callable[..., Running], call: Call) -> None:
    old = "{header: {stamp: {sec: 1}}}"
    start("topic", "pub", "-r", "20", "/range", "sensor_msgs/msg/Range", old)
    delay = start("topic", "delay", "/range")
    seconds = float(delay.wait_for("average delay: ").split()[-1])
    assert seconds == pytest.approx(time.time(), rel=0.01), "since the first second of 1970"
    delay.wait_for("std dev: ")
    start("topic", "pub", "-r", "20", "/chatter", "std_msgs/msg/String", "{data: x}")
    assert "The messages on /chatter have no header" in call("topic", "delay", "/chatter", code=1)


def test_pub_reaches_a_listener(start: Callable[..., Running], call: Call) -> None:
    listener = start("listener", program=True)
    listener.wait_for("ready")
    shown = call("topic", "pub", "--once", "/chatter", "std_msgs/msg/String", "{data: by hand}")
    assert shown.endswith("publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='by hand')\n\n")
    listener.wait_for("heard by hand")
    call("topic", "pub", "-t", "3", "-r", "20", "/chatter", "std_msgs/String", "data: thrice")
    listener.wait_for("heard thrice")


def test_call_says_that_it_waits_for_a_service(start: Callable[..., Running]) -> None:
    waiting = start("service", "call", "/add_two_ints", "my_robot_interfaces/srv/AddTwoInts", "{a: 1, b: 2}")
    waiting.wait_for("waiting for service to become available...")
    start("servers", program=True)
    waiting.wait_for("AddTwoInts_Response(sum=3)")
    assert waiting.end() == 0


def test_ctrl_c_cancels_the_goal(servers: Running, start: Callable[..., Running]) -> None:
    words = ("/fibonacci", "my_robot_interfaces/action/Fibonacci", "{order: 20}", "--feedback")
    goal = start("action", "send_goal", *words)
    goal.wait_for("Feedback:")
    goal.send(signal.SIGINT)
    goal.wait_for("Goal canceled.")
    assert goal.end() == 2
    servers.wait_for("was canceled")


CTRL_C_WHILE_FEEDBACK_IS_TAKEN = cases(__file__, "CTRL_C_WHILE_FEEDBACK_IS_TAKEN")


def test_ctrl_c_cancels_the_goal_also_while_a_message_is_taken(
    servers: Running, start: Callable[..., Running]
) -> None:
    words = ("action", "send_goal", "/fibonacci", "my_robot_interfaces/action/Fibonacci", "{order: 20}")
    goal = start(*words, code=CTRL_C_WHILE_FEEDBACK_IS_TAKEN)
    goal.wait_for("Goal canceled.")
    assert goal.end() == 2


def test_parameters_are_described_written_to_a_file_and_read_from_one(
    talker: Running, call: Call, tmp_path: Path
) -> None:
    assert call("param", "describe", "talker", "rate", "use_sim_time") == (
        "Parameter name: rate\n  Type: double\n  Constraints:\n"
        "Parameter name: use_sim_time\n  Type: boolean\n  Constraints:\n"
    )
    file = tmp_path / "talker.yaml"
    file.write_text(call("param", "dump", "/talker"))
    assert yaml.safe_load(file.read_text())["/talker"]["ros__parameters"]["words"] == "Hello"
    file.write_text(file.read_text().replace("Hello", "Good night"))
    assert "Set parameter words successful\n" in call("param", "load", "/talker", str(file))
    talker.wait_for("said Good night")
    assert "cannot be read" in call("param", "load", "/talker", "no_such.yaml", code=1)
    file.write_text("[1, 2]")
    assert "`ros2 param dump /talker` prints one" in call("param", "load", "/talker", str(file), code=1)
    file.write_text("/other:\n  ros__parameters:\n    words: no\n")
    assert "does not contain parameters for /talker" in call("param", "load", "/talker", str(file), code=1)


def test_doctor_sees_both_sides_of_a_topic(
    talker: Running, ros2: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    done = ros2("doctor", ROS_DISTRO="jazzy")
    assert "Publisher without subscriber detected on /chatter." in done.stderr
    assert done.stdout == "\nAll 4 checks passed\n\n"
    strict = ros2("doctor", "--include-warnings", ROS_DISTRO="jazzy")
    assert "Failed modules: topic" in strict.stdout
    assert "TOPIC LIST" in ros2("doctor", "--report").stdout


def test_other_domains_are_not_seen(
    talker: Running, ros2: Callable[..., subprocess.CompletedProcess[str]], other_domain: str
) -> None:
    assert "/chatter" not in ros2("topic", "list", ROS_DOMAIN_ID=other_domain).stdout
    assert "ROS_DOMAIN_ID is 'mine'" in ros2("topic", "list", ROS_DOMAIN_ID="mine").stderr
