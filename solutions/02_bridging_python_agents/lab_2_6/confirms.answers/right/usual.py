# Right: what the notebook asks for, as a program.
import json
import math
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from agent_interfaces.srv import Ask
from jsonschema import Draft202012Validator
from rclpy.action import ActionClient
from rclpy.duration import Duration
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
    "door": {"room": {"type": "integer", "minimum": 100, "maximum": 499}},
    "done": {},
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


class Legs(Node):
    """Asks the model for a call, does it, and reports what came of it."""

    def __init__(self) -> None:
        super().__init__("planner")
        self.prompt = ""  # the context: what the model gets to read
        self.steps = 0  # how many calls are over
        self.call = ""  # the newest call
        self.open: Any = None  # the future that the plan waits for
        self.goal: Any = None  # the handle of the goal that runs, or None
        self.left = math.inf  # the last distance that this goal told
        self.model = self.create_client(Ask, "model")
        self.switch = self.create_client(SetBool, "lamp")
        self.walker = ActionClient(self, WalkTo, "walk_to")
        self.said = self.create_publisher(String, "said", 10)
        self.create_subscription(String, "order", self.on_order, 10)

    def on_order(self, order: String) -> None:
        """Begin a plan: the next class does it."""

    def on_feedback(self, message: Any) -> None:
        """Look at the distance that is left: the next class does it."""

    def report(self, outcome: str) -> None:
        """Go on after a call: the next class does it."""

    def on_look(self) -> None:
        """Look after an open question: the last class does it."""

    def say(self, text: str) -> None:
        self.said.publish(String(data=text))

    def then(self, future: Future, go_on: Any) -> None:
        """Wait for a future. Its result is given to go_on, unless the plan waits for another one by then."""

        def on_done(done: Future) -> None:
            if done is self.open:
                self.open = None
                go_on(done.result())

        self.open = future
        future.add_done_callback(on_done)

    def begin(self, text: str) -> None:
        """Begin a plan: the context is the order, no goal runs, and no call is over."""
        self.goal, self.prompt, self.steps = None, text, 0
        self.ask()

    def cancel(self) -> None:
        """Cancel the goal that runs, if one does."""
        if self.goal:
            self.goal.cancel_goal_async()

    def ask(self) -> None:
        self.then(self.model.call_async(Ask.Request(context=self.prompt)), self.on_reply)

    def on_reply(self, response: Any) -> None:
        self.call = response.reply
        if fault := find_fault(self.call):
            self.report(f"error: {fault}")
        elif (call := json.loads(self.call))["tool"] == "done":
            self.say("done")
        else:
            getattr(self, call["tool"])(call)

    def lamp(self, call: dict[str, Any]) -> None:
        self.then(self.switch.call_async(SetBool.Request(data=call["on"])), lambda _: self.report("ok"))

    def door(self, call: dict[str, Any]) -> None:
        self.report("error: door is locked")

    def walk_to(self, call: dict[str, Any]) -> None:
        self.left = math.inf
        goal = WalkTo.Goal(x=float(call["x"]), y=float(call["y"]))
        self.open = self.walker.send_goal_async(goal, self.on_feedback)
        self.open.add_done_callback(self.on_goal)

    def on_goal(self, future: Future) -> None:
        if future is not self.open:
            future.result().cancel_goal_async()
        elif future.result().accepted:
            self.goal = future.result()
            self.then(self.goal.get_result_async(), self.on_end)
        else:
            self.report("error: walk_to was rejected")

    def on_end(self, end: Any) -> None:
        self.goal = None
        succeeded = end.status == GoalStatus.STATUS_SUCCEEDED
        self.report("ok" if succeeded else f"error: walk_to ended with status {end.status}")


class Planner(Legs):
    """Does call after call, until the plan is done, used up, or replaced."""

    def report(self, outcome: str) -> None:
        """Write down what came of a call, and go on."""
        self.steps += 1
        self.prompt += f"\n{self.call} -> {outcome}"
        if self.steps < 4:
            self.ask()
        else:
            self.say("I give up")

    def on_order(self, order: String) -> None:
        self.cancel()
        self.begin(order.data)

    def on_feedback(self, message: Any) -> None:
        if message.feedback.distance >= self.left:
            self.cancel()
        self.left = message.feedback.distance


class CarefulPlanner(Planner):
    """Opens a door only if a person says yes in time."""

    def __init__(self) -> None:
        super().__init__()
        self.person = self.create_client(Ask, "confirm")
        self.opener = self.create_client(Ask, "door")
        self.question: Any = None  # the future of the newest question to the person
        self.asked_at: Any = None  # when it was asked
        self.create_timer(0.1, self.on_look)

    def door(self, call: dict[str, Any]) -> None:
        """Ask a person before the door opens."""
        self.asked_at = self.get_clock().now()
        self.question = self.person.call_async(Ask.Request(context=f"open room {call['room']}?"))
        self.then(self.question, self.on_answer)

    def on_answer(self, answer: Any) -> None:
        if answer.reply == "yes":
            room = str(json.loads(self.call)["room"])
            self.then(self.opener.call_async(Ask.Request(context=room)), lambda _: self.report("ok"))
        else:
            self.report("error: door was denied")

    def on_look(self) -> None:
        if self.open and self.open is self.question and self.get_clock().now() - self.asked_at > Duration(seconds=2):
            self.open = None
            self.report("error: door was not confirmed")


rclpy.init()
rclpy.spin(CarefulPlanner())
