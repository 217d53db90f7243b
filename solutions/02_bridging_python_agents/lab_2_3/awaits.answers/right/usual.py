# Right: what the notebook asks for, as a program.
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import Bool, Int32, String
from std_srvs.srv import Trigger


class Heart(Node):
    """Beats, and says what it is asked."""

    def __init__(self) -> None:
        super().__init__("asker")
        self.beats = 0
        self.beat = self.create_publisher(Bool, "beat", 10)
        self.told = self.create_publisher(String, "told", 10)
        self.create_timer(0.1, self.on_beat)

    def on_beat(self) -> None:
        self.beats += 1
        self.beat.publish(Bool(data=True))

    def tell(self, number: int, answer: str) -> None:
        """Say the answer to a question."""
        self.told.publish(String(data=f"{number}: {answer}"))


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
