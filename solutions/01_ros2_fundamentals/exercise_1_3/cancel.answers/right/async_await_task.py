"""Right: one coroutine awaits everything; the feedback callback completes a Future at the third message."""
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future


class AsyncClient(Node):
    def __init__(self, executor):
        super().__init__('async_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.third = Future(executor=executor)
        self.count = 0

    def feedback(self, msg):
        self.count += 1
        if self.count == 3:
            self.third.set_result(list(msg.feedback.partial_sequence))

    async def run(self):
        goal = await self.client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=self.feedback)
        if not goal.accepted:
            self.get_logger().error('the server rejected this goal')
            return
        self.get_logger().info(f'that is enough: {await self.third}')
        await goal.cancel_goal_async()
        answer = await goal.get_result_async()
        self.get_logger().info('goal status is {}, {} numbers came back'.format(answer.status, len(answer.result.sequence)))


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    node = AsyncClient(executor)
    executor.add_node(node)
    if node.client.wait_for_server(timeout_sec=8.0):
        executor.spin_until_future_complete(executor.create_task(node.run()))
    rclpy.shutdown()


if __name__ == '__main__':
    main()
