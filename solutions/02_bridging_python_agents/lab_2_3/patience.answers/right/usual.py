# Right: what the notebook asks for, as a program.
from functools import partial
from typing import Any

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger


class Heart(Node):
    """Beats, and tells answers."""

    def __init__(self) -> None:
        super().__init__("asker")
        self.answers: list[str] = []
        self.beat = self.create_publisher(Int32, "beat", 10)
        self.told = self.create_publisher(String, "told", 10)
        self.create_timer(0.1, self.on_beat)

    def on_beat(self) -> None:
        self.beat.publish(Int32(data=len(self.answers)))

    def tell(self, number: int, answer: str) -> None:
        """Say the answer to a question."""
        self.answers.append(f"{number}: {answer}")
        self.told.publish(String(data=self.answers[-1]))


class AskingHeart(Heart):
    """Can ask where the door is."""

    def __init__(self) -> None:
        super().__init__()
        self.where = self.create_client(Trigger, "where")
        self.create_subscription(Int32, "ask", self.on_ask, 10)

    def on_ask(self, number: Int32) -> None:
        """Answer a question: a subclass does it."""


class Asker(AskingHeart):
    """Asks without waiting."""

    def on_ask(self, number: Int32) -> None:
        """Ask where the door is."""
        future = self.where.call_async(Trigger.Request())
        future.add_done_callback(partial(self.on_answer, number.data))

    def on_answer(self, number: int, future: Future) -> None:
        """Say the answer to a question."""
        self.tell(number, future.result().message)


class PatientAsker(Asker):
    """Gives a question up after two seconds."""

    def __init__(self) -> None:
        super().__init__()
        self.open: dict[int, Any] = {}

    def on_ask(self, number: Int32) -> None:
        self.open[number.data] = self.get_clock().now()
        super().on_ask(number)

    def tell(self, number: int, answer: str) -> None:
        """Say the answer to a question that is still open."""
        if self.open.pop(number, None):
            super().tell(number, answer)

    def on_beat(self) -> None:
        """Beat, and give up what has been open for too long."""
        super().on_beat()
        for number, asked_at in list(self.open.items()):
            if self.get_clock().now() - asked_at > Duration(seconds=2):
                self.tell(number, "no answer")


rclpy.init()
rclpy.spin(PatientAsker())
