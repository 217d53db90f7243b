"""The verbs against real nodes."""

from __future__ import annotations

import re
import signal
import time
from typing import TYPE_CHECKING

import pytest
import yaml

from tests.cases import cases

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


def test_topics_of_a_talker(talker: Running, call: Call) -> None:
    assert call("topic", "list") == "/chatter\n/parameter_events\n/rosout\n"
    assert call("topic", "list", "-t").splitlines()[0] == "/chatter [std_msgs/msg/String]"
    assert call("topic", "list", "-c") == "3\n"
    details = call("topic", "list", "-v")
    assert details.startswith("Published topics:\n * /chatter [std_msgs/msg/String] 1 publisher\n")
    assert "\nSubscribed topics:\n" in details
    assert call("topic", "type", "/chatter") == "std_msgs/msg/String\n"
    assert call("topic", "type", "/chater", code=1) == ""
    assert call("topic", "find", "std_msgs/msg/String") == "/chatter\n"


def test_info_counts_and_names_endpoints(talker: Running, call: Call) -> None:
    assert call("topic", "info", "/chatter") == (
        "Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 0\n"
    )
    details = call("topic", "info", "-v", "/chatter")
    assert "Node name: talker\nNode namespace: /\nTopic type: std_msgs/msg/String\n" in details
    assert "  Reliability: RELIABLE\n" in details
    assert call("topic", "info", "/chater", code=1) == "Unknown topic '/chater'\n"


def test_echo_shows_a_message_as_yaml(talker: Running, call: Call) -> None:
    assert re.fullmatch(r"data: Hello \d+\n---\n", call("topic", "echo", "--once", "/chatter"))
    assert re.fullmatch(r"Hello \d+\n---\n", call("topic", "echo", "--once", "/chatter", "--field", "data"))
    assert re.fullmatch(r"Hello \d+\n", call("topic", "echo", "--once", "/chatter", "--csv"))
    filtered = call("topic", "echo", "--once", "/chatter", "--filter", "int(m.data.split()[1]) % 5 == 0")
    assert re.fullmatch(r"data: Hello \d*[05]\n---\n", filtered)
    info = call("topic", "echo", "--once", "-i", "/chatter")
    assert "source_timestamp: " in info


def test_echo_ends_in_time_and_names_what_is_wrong(talker: Running, call: Call) -> None:
    assert call("topic", "echo", "/silence", "std_msgs/msg/String", "--timeout", "0.2") == ""
    assert "Could not determine the type" in call("topic", "echo", "/silence", code=1)
    assert "message type is invalid" in call("topic", "echo", "/chatter", "std_msgs/msg/Strin", code=1)
    assert "Invalid field 'dta'" in call("topic", "echo", "/chatter", "--field", "dta", code=1)


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


def test_pub_names_what_is_wrong(call: Call) -> None:
    pub = ("topic", "pub", "--once", "/x")
    assert call(*pub, "std_msgs/msg/Strin", code=1) == "The passed message type is invalid\n"
    assert "object has no attribute 'dta'" in call(*pub, "std_msgs/msg/String", "{dta: x}", code=1)
    assert "Expected 1 subcribers but only got 0" in call(
        *pub, "std_msgs/msg/String", "{data: x}", "--max-wait-time-secs", "0.1", code=1
    )


def test_a_service_is_found_and_called(servers: Running, call: Call) -> None:
    assert "/add_two_ints" in call("service", "list").splitlines()
    assert "/add_two_ints [my_robot_interfaces/srv/AddTwoInts]" in call("service", "list", "-t")
    assert not any("/_action/" in name for name in call("service", "list").splitlines())
    assert call("service", "type", "/add_two_ints") == "my_robot_interfaces/srv/AddTwoInts\n"
    assert call("service", "find", "my_robot_interfaces/srv/AddTwoInts") == "/add_two_ints\n"
    assert call("service", "info", "/add_two_ints") == (
        "Type: my_robot_interfaces/srv/AddTwoInts\nClients count: 0\nServices count: 1\n"
    )
    assert call("service", "info", "/add", code=1) == "Unknown service '/add'\n"
    answer = call("service", "call", "/add_two_ints", "my_robot_interfaces/srv/AddTwoInts", "{a: 10, b: 20}")
    assert answer == (
        "requester: making request: my_robot_interfaces.srv.AddTwoInts_Request(a=10, b=20)\n\n"
        "response:\nmy_robot_interfaces.srv.AddTwoInts_Response(sum=30)\n\n"
    )


def test_call_names_what_is_wrong(call: Call) -> None:
    assert "service type is invalid" in call("service", "call", "/x", "std_srvs/srv/Nothing", code=1)
    wrong = call("service", "call", "/x", "my_robot_interfaces/srv/AddTwoInts", "{c: 1}", code=1)
    assert wrong == "Failed to populate field: 'AddTwoInts_Request' object has no attribute 'c'\n"


def test_call_says_that_it_waits_for_a_service(start: Callable[..., Running]) -> None:
    waiting = start("service", "call", "/add_two_ints", "my_robot_interfaces/srv/AddTwoInts", "{a: 1, b: 2}")
    waiting.wait_for("waiting for service to become available...")
    start("servers", program=True)
    waiting.wait_for("AddTwoInts_Response(sum=3)")
    assert waiting.end() == 0


def test_an_action_is_found_and_described(servers: Running, call: Call) -> None:
    assert call("action", "list") == "/fibonacci\n"
    assert call("action", "list", "-t") == "/fibonacci [my_robot_interfaces/action/Fibonacci]\n"
    assert call("action", "type", "/fibonacci") == "my_robot_interfaces/action/Fibonacci\n"
    assert call("action", "type", "/fibonaci", code=1) == ""
    assert call("action", "info", "/fibonacci") == (
        "Action: /fibonacci\nAction clients: 0\nAction servers: 1\n    /desk/servers\n"
    )


def test_a_goal_with_feedback(servers: Running, call: Call) -> None:
    words = ("action", "send_goal", "/fibonacci", "my_robot_interfaces/action/Fibonacci", "{order: 3}", "-f")
    shown = call(*words)
    assert re.fullmatch(
        r"Waiting for an action server to become available\.\.\.\n"
        r"Sending goal:\n     order: 3\n\n"
        r"Goal accepted with ID: [0-9a-f]{32}\n\n"
        r"Feedback:\n    partial_sequence:\n- 0\n- 1\n- 1\n\n"
        r"Feedback:\n    partial_sequence:\n- 0\n- 1\n- 1\n- 2\n\n"
        r"Result:\n    sequence:\n- 0\n- 1\n- 1\n- 2\n\n"
        r"Goal finished with status: SUCCEEDED\n",
        shown,
    )


def test_a_rejected_goal(servers: Running, call: Call) -> None:
    words = ("action", "send_goal", "/fibonacci", "my_robot_interfaces/action/Fibonacci", "{order: 21}")
    assert call(*words).endswith("Goal was rejected.\n")


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


def test_nodes(talker: Running, servers: Running, call: Call) -> None:
    assert call("node", "list") == "/desk/servers\n/talker\n"
    assert call("node", "list", "-c") == "2\n"
    info = call("node", "info", "/desk/servers")
    assert info.startswith("/desk/servers\n  Subscribers:\n\n  Publishers:\n    /parameter_events: ")
    assert "  Service Servers:\n    /add_two_ints: my_robot_interfaces/srv/AddTwoInts\n" in info
    assert info.endswith(
        "  Action Servers:\n    /fibonacci: my_robot_interfaces/action/Fibonacci\n  Action Clients:\n\n"
    )
    assert call("node", "info", "/nobody", code=1) == "Unable to find node '/nobody'\n"


def test_parameters(talker: Running, call: Call) -> None:
    assert call("param", "list", "/talker") == (
        "  rate\n  start_type_description_service\n  use_sim_time\n  words\n"
    )
    assert call("param", "list").startswith("/talker:\n  rate\n")
    assert "  rate (type: double)\n" in call("param", "list", "/talker", "--param-type")
    assert call("param", "get", "/talker", "words") == "String value is: Hello\n"
    assert call("param", "get", "talker", "rate", "--hide-type") == "10.0\n"
    assert call("param", "set", "/talker", "words", "Good day") == "Set parameter successful\n"
    assert call("param", "get", "/talker", "words") == "String value is: Good day\n"
    talker.wait_for("said Good day")
    assert call("param", "get", "/talker", "nothing", code=1) == "Parameter not set\n"
    assert call("param", "get", "/nobody", "words", "--timeout", "0", code=1) == "Node not found\n"


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


def test_setting_a_wrong_type_fails(
    talker: Running, ros2: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    done = ros2("param", "set", "/talker", "use_sim_time", "maybe")
    assert done.stderr.startswith("Setting parameter failed: Wrong parameter type")
    assert done.returncode == 0


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
