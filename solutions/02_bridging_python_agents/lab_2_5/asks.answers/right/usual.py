# Right: what the notebook asks for, as a program.
import json
from typing import Any

import rclpy
from agent_interfaces.srv import Ask
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
}


def find_fault(text: str) -> str:
    """Return what is wrong with a call, beginning with the name of the field; an empty text if nothing is."""
    try:
        call = json.loads(text)
    except ValueError:
        return "json only, please: your whole reply has to be one object"
    if not isinstance(call, dict) or call.get("tool") not in list(TOOLS):
        return f"tool has to be one of {list(TOOLS)}"
    for name, schema in TOOLS[call["tool"]].items():
        value = call.get(name)
        if not Draft202012Validator(schema).is_valid(value) or value != value:
            return f"{name} is {value}, and has to fit {schema}"
    return ""


class Hands(Node):
    """Hears orders, and does calls."""

    def __init__(self) -> None:
        super().__init__("interpreter")
        self.prompt = ""
        self.tries = 0
        self.model = self.create_client(Ask, "model")
        self.switch = self.create_client(SetBool, "lamp")
        self.walker = ActionClient(self, WalkTo, "walk_to")
        self.said = self.create_publisher(String, "said", 10)
        self.create_subscription(String, "order", self.on_order, 10)

    def say(self, text: str) -> None:
        self.said.publish(String(data=text))

    def do(self, call: dict[str, Any]) -> None:
        """Do a call that was checked."""
        if call["tool"] == "lamp":
            self.switch.call_async(SetBool.Request(data=call["on"]))
        else:
            self.walker.send_goal_async(WalkTo.Goal(x=float(call["x"]), y=float(call["y"])))

    def on_order(self, order: String) -> None:
        """Ask the model about a new order."""
        self.prompt, self.tries = order.data, 0
        self.ask()

    def ask(self) -> None:
        """Ask the model: the next class does it."""

    def on_look(self) -> None:
        """Look after an open question: the last class does it."""


class Interpreter(Hands):
    """Makes goals of words, in three tries."""

    def ask(self) -> None:
        self.tries += 1
        self.model.call_async(Ask.Request(context=self.prompt)).add_done_callback(self.on_reply)

    def on_reply(self, future: Future) -> None:
        reply = future.result().reply
        if not (fault := find_fault(reply)):
            self.do(json.loads(reply))
            self.say("done")
        elif self.tries < 3:
            self.prompt += f"\nerror: {fault}"
            self.ask()
        else:
            self.say("I do not understand")


rclpy.init()
rclpy.spin(Interpreter())
