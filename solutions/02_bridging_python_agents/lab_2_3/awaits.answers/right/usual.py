# Right: what the notebook asks for, as a program.
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
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


class AwaitingAsker(Heart):
    """Asks and awaits."""

    def __init__(self) -> None:
        super().__init__()
        group = ReentrantCallbackGroup()
        self.where = self.create_client(Trigger, "where", callback_group=group)
        self.create_subscription(Int32, "ask", self.on_question, 10, callback_group=group)

    async def on_question(self, number: Int32) -> None:
        """Ask, await the answer, and say it."""
        answer = await self.where.call_async(Trigger.Request())
        self.tell(number.data, answer.message)


rclpy.init()
rclpy.spin(AwaitingAsker())
