# Right: done callbacks.
import json
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future
from small_robot_interfaces.action import WalkTo
from std_msgs.msg import String
from std_srvs.srv import SetBool


class Ears(Node):
    """Hears orders."""

    place = None  # where to go

    def __init__(self) -> None:
        super().__init__("courier")
        self.said = self.create_publisher(String, "said", 10)
        self.door = self.create_client(SetBool, "door")
        self.walker = ActionClient(self, WalkTo, "walk_to")
        self.create_subscription(String, "order", self.hear, 10)

    def hear(self, message: String) -> None:
        """Hear an order."""
        try:
            order = json.loads(message.data)
            self.place = WalkTo.Goal(x=float(order["x"]), y=float(order["y"]))
        except (ValueError, KeyError, TypeError):
            self.say("refused")
        else:
            self.open()

    def say(self, text: str) -> None:
        self.said.publish(String(data=text))

    def open(self) -> None:
        """Have the door opened: the next class does it."""


class Courier(Ears):
    """Walks through doors."""

    def open(self) -> None:
        self.door.call_async(SetBool.Request(data=True)).add_done_callback(self.on_door)

    def on_door(self, future: Future) -> None:
        if future.result().success:
            self.walker.send_goal_async(self.place).add_done_callback(self.on_goal)
        else:
            self.say("locked")

    def on_goal(self, future: Future) -> None:
        future.result().get_result_async().add_done_callback(self.on_end)

    def on_end(self, future: Any) -> None:
        self.say("done" if future.result().status == GoalStatus.STATUS_SUCCEEDED else "lost")


rclpy.init()
rclpy.spin(Courier())
