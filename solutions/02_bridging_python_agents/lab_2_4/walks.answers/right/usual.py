# Right: what the notebook asks for, as a program.
import json
import math
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from jsonschema import Draft202012Validator
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future
from small_robot_interfaces.action import WalkTo
from std_msgs.msg import String
from std_srvs.srv import SetBool

TOOLS: dict[str, dict[str, Any]] = {
    "lamp": {"on": {"type": "boolean"}},
    "walk_to": {
        "x": {"type": "number", "minimum": 0, "maximum": 6},
        "y": {"type": "number", "minimum": 0, "maximum": 4},
    },
    "say": {"text": {"type": "string", "minLength": 1, "maxLength": 60}},
}


def fits(value: Any, schema: dict[str, Any]) -> bool:
    """Return True if a schema allows a value."""
    return Draft202012Validator(schema).is_valid(value)


def find_fault(text: str) -> Any:
    """Return what is wrong with a call, beginning with the name of the field; an empty text if nothing is."""
    try:
        call = json.loads(text)
    except ValueError:
        call = None
    if not isinstance(call, dict):
        return "json has to be an object"
    if call.get("tool") not in list(TOOLS):
        return f"tool has to be one of {list(TOOLS)}"
    for name, schema in TOOLS[call["tool"]].items():
        if not fits(value := call.get(name), schema) or (isinstance(value, float) and not math.isfinite(value)):
            return f"{name} is {value}, and has to fit {schema}"
    return ""


class Desk(Node):
    """Hears calls, and answers them."""

    def __init__(self) -> None:
        super().__init__("desk")
        self.result = self.create_publisher(String, "result", 10)
        self.speech = self.create_publisher(String, "speech", 10)
        self.switch = self.create_client(SetBool, "lamp")
        self.create_subscription(String, "call", self.on_call, 10)

    def on_call(self, message: String) -> None:
        """Check a call, and do it."""

    def answer(self, text: str) -> None:
        """Tell the model what came of its call."""
        self.result.publish(String(data=text))

    def say(self, call: dict[str, Any]) -> None:
        """Say a text."""
        self.speech.publish(String(data=call["text"]))
        self.answer("ok")

    def walk_to(self, call: dict[str, Any]) -> None:
        """Walk: a later class does it."""
        self.answer("error: walk_to is not there yet")


class Toolbox(Desk):
    """Does what is called, and switches the lamp."""

    def on_call(self, message: String) -> None:
        if fault := find_fault(message.data):
            self.answer(f"error: {fault}")
        else:
            call = json.loads(message.data)
            getattr(self, call["tool"])(call)

    def lamp(self, call: dict[str, Any]) -> None:
        self.switch.call_async(SetBool.Request(data=call["on"])).add_done_callback(self.on_lamp)

    def on_lamp(self, future: Future) -> None:
        done = future.result()
        self.answer("ok" if done.success else f"error: lamp {done.message}")


class Legs(Toolbox):
    """Walks, too."""

    def __init__(self) -> None:
        super().__init__()
        self.walker = ActionClient(self, WalkTo, "walk_to")

    def walk_to(self, call: dict[str, Any]) -> None:
        goal = WalkTo.Goal(x=float(call["x"]), y=float(call["y"]))
        self.walker.send_goal_async(goal).add_done_callback(self.on_goal)

    def on_goal(self, future: Future) -> None:
        if future.result().accepted:
            future.result().get_result_async().add_done_callback(self.on_end)
        else:
            self.answer("error: walk_to was rejected")

    def on_end(self, future: Future) -> None:
        succeeded = future.result().status == GoalStatus.STATUS_SUCCEEDED
        self.answer("ok" if succeeded else f"error: walk_to ended with status {future.result().status}")


rclpy.init()
rclpy.spin(Legs())
