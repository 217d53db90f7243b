"""The table of known errors: each row has a source that it matches, and real exceptions get what is written here."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from autograder import course, known_errors
from autograder.authoring.answer_bank import Answer, answers
from autograder.judge import evidence_files
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.mistakes.package_mistakes import build_report
from autograder.notebook.nodes import ros_session
from tests.measure import evidence as kept_evidence

if TYPE_CHECKING:
    from autograder.known_errors import KnownError

SETTING = """
import asyncio, json, linecache, sys, traceback
import rclpy, rclpy.action, std_msgs
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

class Talker(Node):
    pass

rclpy.init()
node, on_message = Talker("talker"), lambda message: None
client, future = node.create_client(Trigger, "add"), rclpy.Future()

def no_message():
    return 1

def ask(node, client, number):
    return client.call_async(Trigger.Request())

shown = {}
for number, code in enumerate(json.load(sys.stdin)):
    linecache.cache[f"cell_{number}"] = len(code), None, code.splitlines(True), f"cell_{number}"
    try:
        exec(compile(code, f"cell_{number}", "exec"), globals())
        shown[code] = ""
    except Exception:
        shown[code] = traceback.format_exc()
print(json.dumps(shown))
"""
SAYS = {
    # ROS 1
    "import rospy": "belongs to ROS 1",
    "from actionlib import SimpleActionServer": "belongs to ROS 1",
    "rospy.loginfo('hello')": "self.get_logger().info",
    "rospy.logwarn_once('hello')": "self.get_logger().info",
    "rospy.Service('add', Trigger, on_message)": "self.create_service",
    "rospy.ServiceProxy('add', Trigger)": "node.create_client",
    "pub = rospy.Publisher('chatter', String, queue_size=10)": "self.create_publisher(String, 'chatter', 10)",
    "rospy.Subscriber('chatter', String, on_message)": "self.create_subscription(String, 'chatter'",
    "while not rospy.is_shutdown(): pass": "while rclpy.ok():",
    "rospy.anything()": "self.create_publisher(String, 'chatter', 10)",
    "rclpy.init_node('talker')": "class YourNode(Node)",
    "rclpy.Rate(2)": "self.create_timer(0.5, self.tick)",
    "node.loginfo('hello')": "self.get_logger().info",
    "node.get_logger().logerr('hello')": "self.get_logger().info",
    "node.create_publisher('chatter', String, queue_size=10)": "First the type, then the name, and the depth",
    "node.create_publisher(String, 'chatter', 10, latch=True)": "latch= belongs to ROS 1",
    "node.create_publisher('chatter', String, 10)": "create_publisher(String, 'chatter', 10)",
    "node.create_subscription('chatter', String, on_message, 10)": "The type String is where the name belongs",
    "from my_robot_interfaces.srv import AddTwoIntsResponse": "AddTwoInts.Response",
    "AddTwoIntsRequest(a=1, b=2)": "AddTwoInts.Request",
    # packages
    "from std_msgs import String": "from std_msgs.msg import String",
    "from geometry_msgs import Pose": "from geometry_msgs.msg import Pose",
    "import std_msgs.String": "from std_msgs.msg import String",
    "std_msgs.String()": "from std_msgs.msg import String",
    "from std_srvs import SetBool": "from std_srvs.srv import SetBool",
    "from my_robot_interfaces import Fibonacci": ".action in place of .srv for an action",
    "from action_tutorials_interfaces.action import Fibonacci": "write my_robot_interfaces in place of action_t",
    "from tutorial_interfaces.srv import AddThreeInts": "belongs to other tutorials",
    # another ROS 2
    "with rclpy.init(): pass": "leave out rclpy.init()",  # a second one here
    "with node: pass": "newer ROS 2 than Jazzy",
    "from rclpy.executors import EventsExecutor": "newer ROS 2 than Jazzy",
    "rclpy.init()": "start_ros() has done it",
    # asyncio
    "async def tick():\n    await asyncio.sleep(1)\ntick().send(None)": "Leave asyncio out",
    "async def tick():\n    asyncio.run(on_message)\nasyncio.run(tick())": "Leave asyncio out",
    # C++ and others
    "import rclcpp": "this course writes ROS 2 in Python",
    "RCLCPP_INFO(node.get_logger(), 'hello')": "self.get_logger().info",
    "node.create_wall_timer(0.5, on_message)": "create_timer(0.5, self.tick)",
    "node.create_publisher<String>('chatter', 10)": "create_publisher(String, 'chatter', 10)",
    "node.create_client(Trigger, 'x').async_send_request(1)": "call_async",
    "rclpy.spin_some(node)": "rclpy.spin(your_node)",
    "this.count = 0": "In Python, write self",
    "done = true": "True, False or None",
    "answer = nullptr": "True, False or None",
    "message = std_msgs::msg::String()": "Write a dot in place of ::",
    "node->publish(1)": "Write a dot in place of ::",
    # a terminal's command in a cell
    "ros2 topic list": "%%bash --no-raise-error",
    "colcon build --packages-select my_robot_pkg": "%%bash --no-raise-error",
    "source install/setup.bash": "%%bash --no-raise-error",
    "cd ros2_ws": "%%bash --no-raise-error",
    "./course check lab_1_1.hello": "%%bash --no-raise-error",
    "ros2": "%%bash --no-raise-error",
    "roscore": "without a master",
    "rosrun turtlesim turtlesim_node": "`ros2 run`",
    "rqt_graph": "`ros2 topic list -t`",
    "rviz2": "`ros2 topic list -t`",
    # imports
    "from rclpy import Node": "from rclpy.node import Node",
    "class Talk(rclpy.Node): pass": "from rclpy.node import Node",
    "from rclpy.action import GoalStatus": "from action_msgs.msg import GoalStatus",
    "from my_robot_pkg.srv import AddTwoInts": "The course's own types are in my_robot_interfaces",
    "from std_msg.msg import String": "Write std_msgs in the import",
    "from my_robot_interface.srv import AddTwoInts": "Write my_robot_interfaces in the import",
    "from std_msgs.msgs import String": "without an s",
    "GoalResponse.ACCEPT": "from rclpy.action import GoalResponse",
    "from rclpy.node import AsyncNode": "newer ROS 2 than Jazzy",
    # arguments
    "node.create_timer(on_message, 0.5)": "Write create_timer(0.5, on_message)",
    "rclpy.spin_until_future_complete(future, node)": "Write spin_until_future_complete(node, future, ...)",
    "ask(client, node, 1)": "Write ask(node, client, ...)",
    "node.create_service(Trigger, 'x', on_message, 10)": "no queue depth",
    "node.create_client(Trigger, 'x', 10)": "no queue depth",
    "rclpy.action.ActionClient(Trigger, 'x')": "Here self is written by hand",
    "Trigger.Request(1, 2)": "fields of a message are given by name",
    "String('hello')": "fields of a message are given by name",
    "Trigger(a=1)": "Trigger itself has no fields",
    "node.create_service(Trigger(), 'x', on_message)": "Write Trigger without parentheses",
    "node.create_service(Trigger.Request, 'x', on_message)": "Write Trigger in place of Trigger.Request",
    "node.create_client(srv_type=Trigger.Response, srv_name='x')": "Write Trigger in place of Trigger.Response",
    "publisher = node.create_publisher(String(), 'x', 10)\npublisher.publish(String())": "without parentheses",
    "node.create_subscription(String, 'x', no_message, 10)": "def no_message(self, message)",
    "node.create_subscription(String, 'x', no_message(), 10)": "Pass only the name, no_message",
    # classes
    "class Talk(Node):\n    def __init__(self):\n        super('talk')\nTalk()": "super().__init__('talk')",
    "node = Talker\nnode.destroy_node()": "write parentheses at its end",
    "def ask(future):\n    await future": "spin_until_future_complete",
}
NOTHING = (
    "node.anything()",
    "from rclpy.action import GoalRespnse",
    "import my_own_package",
    "from std_msgs.msg import Strng",
    "node.create_publisher(String, 'chatter', depth=10)",
    "1 < 'a'",
    "numbers = [1, 2][::]]",
    "last = numbers[first::step",
    "print(std)",
    "def f(x)->int return x",
    "rclpy.Anything()",
    "node.get_param('speed')",  # Python itself names get_parameter, which the node has
    "1 + 1",
)


@pytest.fixture(scope="module")
def shown() -> dict[str, str]:
    """The traceback of each piece of code in a process with ROS; empty if it ended with none."""
    codes = json.dumps([*SAYS, *NOTHING])
    run = subprocess.run([sys.executable, "-c", SETTING], input=codes, capture_output=True, text=True)
    found: dict[str, str] = json.loads(run.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize(("code", "words"), SAYS.items())
def test_a_real_exception_is_named_with_what_is_written_here(
    shown: dict[str, str], code: str, words: str
) -> None:
    row = known_errors.recognized(shown[code], "cell", "my_robot_interfaces")
    assert row is not None, shown[code]
    assert words in f"{row.means} {row.do}"


@pytest.mark.parametrize("code", NOTHING)
def test_nothing_is_said_of_other_code(shown: dict[str, str], code: str) -> None:
    assert known_errors.recognized(shown[code], "cell", "my_robot_interfaces") is None


ROWS = known_errors.rows()
BANK = {answer.name: answer for answer in answers()}


def sources(row: KnownError) -> list[str]:
    """The sources of a row: addresses, answers of the bank, files of this repository."""
    return [row.source] if isinstance(row.source, str) else row.source


@functools.cache
def heard(answer: Answer) -> dict[str, str]:
    """What was heard of an answer, by where: its traceback, its output and the line of its build."""
    line = kept_evidence.kept(answer.exercise).get(answer.name)
    record = kept_evidence.record_of(answer, line)
    evidence = evidence_files.evidence_of(record.seen, evidence_files.load_reference(answer.exercise))
    report = build_report(evidence.main)
    return {
        "program": traceback_of(evidence),
        "terminal": "\n".join(text for part in evidence for text in part.said()),
        "build": report.line if report else "",
    }


def deciding(row: KnownError, said: dict[str, str]) -> bool:
    """Whether a row is the first that matches what was heard, in one of its places."""
    return any(
        next(
            (one for one in ROWS if place in one.heard and known_errors.pattern_of(one).search(said[place])),
            None,
        )
        is row
        for place in row.heard
        if said.get(place)
    )


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.key}: {row.means[:40]}")
def test_each_row_has_a_source_that_it_matches(row: KnownError) -> None:
    assert sources(row)
    for source in sources(row):
        if source.startswith("https://"):
            continue
        if source in BANK:
            assert deciding(row, heard(BANK[source])), f"another row decides on {source}"
        else:
            message = known_errors.pattern_of(row).pattern.rpartition(")")[2]
            assert message in (course.root() / source).read_text(encoding="utf-8")


def test_no_row_matches_a_right_answer() -> None:
    """A right answer may raise an exception of its own, print, and build; nothing of it is a known error."""
    patterns = [(row, known_errors.pattern_of(row)) for row in ROWS]
    for answer in answers():
        if answer.diagnoses:
            continue
        said = heard(answer)
        hits = [
            row.means
            for row, pattern in patterns
            for place in row.heard
            if pattern.search(said.get(place, ""))
        ]
        assert not hits, f"{answer.name}: {hits}"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.key}: {row.means[:40]}")
def test_the_texts_of_a_row_can_be_filled_in(row: KnownError) -> None:
    names = known_errors.pattern_of(row).groupindex
    words = dict.fromkeys((*names, "here", "owner", "future", "each"), known_errors.Name("x"))
    assert "{" not in row.means.format(**words) + row.do.format(**words).replace("{number}", "").replace(
        "{message.data}", ""
    ).replace("{response.sum}", "").replace("with a }", "").replace("each {", "")


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("rqt_graph", "`rqt_graph` is a program with a window of its own"),
        ("roscore", "`roscore` is a command of ROS 1"),
        ("rosrun a b", "The commands of ROS 2 are `ros2 run`"),
        ("no_such_command", ""),
    ],
)
def test_a_command_that_a_cell_of_bash_does_not_find_is_explained(command: str, says: str) -> None:
    shell = subprocess.run(
        ["bash", "-c", command], env=ros_session._DEFAULTS, capture_output=True, text=True, check=False
    )
    assert shell.returncode == 127
    first, *more = shell.stderr.splitlines()
    assert first == f"bash: {command.split()[0]}: command not found"
    assert says in "".join(more)
    assert bool(more) == bool(says)
