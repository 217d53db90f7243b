"""Right: an execute callback that awaits a timer, so that one thread is enough."""
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        self.server = ActionServer(
            self, Fibonacci, 'fibonacci', self.execute,
            goal_callback=self.judge, cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def judge(self, request):
        return GoalResponse.ACCEPT if 0 <= request.order < 47 else GoalResponse.REJECT

    async def pause(self, seconds):
        done = Future()
        timer = self.create_timer(seconds, lambda: done.set_result(None) if not done.done() else None)
        await done
        timer.cancel()
        self.destroy_timer(timer)

    async def execute(self, goal):
        feedback = Fibonacci.Feedback(partial_sequence=[0, 1])
        while len(feedback.partial_sequence) <= goal.request.order and not goal.is_cancel_requested:
            *_, a, b = feedback.partial_sequence
            feedback.partial_sequence.append(a + b)
            goal.publish_feedback(feedback)
            await self.pause(0.2)
        if len(feedback.partial_sequence) <= goal.request.order:
            goal.canceled()
        else:
            goal.succeed()
        return Fibonacci.Result(sequence=feedback.partial_sequence)


def main():
    rclpy.init()
    rclpy.spin(Counter())


if __name__ == '__main__':
    main()
