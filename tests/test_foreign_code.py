"""Code of elsewhere, as Python and rclpy end it, and what is said of it: every exception here is a real one."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from autograder.foreign_code import recognized

SETTING = """
import asyncio, json, linecache, sys, traceback
import rclpy, std_msgs
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

class Talker(Node):
    pass

rclpy.init()
node, on_message = Talker("talker"), lambda message: None
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
}
NOTHING = (
    "node.anything()",
    "from rclpy.action import GoalRespnse",
    "GoalResponse.ACCEPT",
    "import my_own_package",
    "from std_msgs.msg import Strng",
    "node.create_publisher(String, 'chatter', depth=10)",
    "node.create_timer(on_message, 0.5)",
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
def test_code_of_elsewhere_is_named_with_what_is_written_here(
    shown: dict[str, str], code: str, words: str
) -> None:
    found = recognized(shown[code], "my_robot_interfaces")
    assert found is not None, shown[code]
    assert words in f"{found.text} {found.next_step}"


@pytest.mark.parametrize("code", NOTHING)
def test_nothing_is_said_of_other_code(shown: dict[str, str], code: str) -> None:
    assert recognized(shown[code], "my_robot_interfaces") is None
