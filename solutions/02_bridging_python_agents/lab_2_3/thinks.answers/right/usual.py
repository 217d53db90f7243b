# Right: what the notebook asks for, as a program.
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool


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


class SlowAgent:
    """An agent far away: decide asks for a direction, and blocks until it is there."""

    def __init__(self, node: Node) -> None:
        self.oracle = node.create_client(SetBool, "oracle")

    def decide(self, number: int) -> str:
        return self.oracle.call(SetBool.Request(data=number % 2 == 0)).message


class Thinker(Heart):
    """Lets an agent think, and does not wait for it."""

    def __init__(self) -> None:
        super().__init__()
        self.agent = SlowAgent(self)
        self.newest = 0
        self.create_subscription(Int32, "seen", self.on_seen, 10)

    def on_seen(self, number: Int32) -> None:
        """Begin to think about an observation."""
        self.newest = number.data
        threading.Thread(target=self.think, args=(number.data,), daemon=True).start()

    def think(self, number: int) -> None:
        """Let the agent decide, and say the decision if it still matters."""
        decision = self.agent.decide(number)
        if number == self.newest:
            self.tell(number, decision)


rclpy.init()
rclpy.spin(Thinker())
