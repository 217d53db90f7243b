"""Right: a coroutine as callback, several threads, a reentrant group."""
import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Adder(Node):
    def __init__(self, name='adder'):
        super().__init__(name)
        self.create_service(
            AddTwoInts, 'add_two_ints', self.serve, callback_group=ReentrantCallbackGroup()
        )

    async def serve(self, request, response):
        response.sum = sum((request.a, request.b))
        return response


def main(args=None):
    with Ros(args):
        executor = MultiThreadedExecutor(num_threads=4)
        executor.add_node(Adder())
        executor.spin()


class Ros:
    def __init__(self, args):
        self.args = args

    def __enter__(self):
        rclpy.init(args=self.args)

    def __exit__(self, *_):
        rclpy.try_shutdown()
        return True


if __name__ == '__main__':
    main()
