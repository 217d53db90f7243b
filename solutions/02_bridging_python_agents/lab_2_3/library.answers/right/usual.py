# Right: what the notebook asks for, as a program.
import asyncio
import threading

import rclpy
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


class Library:
    """Puts an answer in words. You cannot change it."""

    async def put_in_words(self, place: str) -> str:
        await asyncio.sleep(0)
        return f"It is {place}"


class LoopAsker(Heart):
    """Asks in a loop of asyncio, next to the executor."""

    def __init__(self) -> None:
        super().__init__()
        self.library = Library()
        self.where = self.create_client(Trigger, "where")
        self.create_subscription(Int32, "ask", self.on_question, 10)
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()

    async def guide(self, number: int) -> None:
        """Ask, let the library put the answer in words, and say it."""
        self.tell(number, await self.library.put_in_words(await self.ask()))

    def on_question(self, number: Int32) -> None:
        """Let the loop guide."""
        asyncio.run_coroutine_threadsafe(self.guide(number.data), self.loop)

    async def ask(self) -> str:
        place = self.loop.create_future()

        def hand_over(future: Future) -> None:
            self.loop.call_soon_threadsafe(place.set_result, future.result().message)

        self.where.call_async(Trigger.Request()).add_done_callback(hand_over)
        return await place


rclpy.init()
rclpy.spin(LoopAsker())
