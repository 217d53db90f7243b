"""Wrong, row 19: the course text's own client with the interface package's name adapted; call() waits, nobody spins."""
import sys
import rclpy
from rclpy.node import Node
from my_robot_interfaces.srv import AddTwoInts


class AddThreeIntsClient(Node):
    def __init__(self):
        super().__init__('add_three_ints_client')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        while not self.cli.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('add_two_ints service not available, waiting again...')
        self.req = AddTwoInts.Request()
        self.get_logger().info('Add three ints client ready.')

    def send_request(self, a, b, c):
        # First call: a + b
        self.req.a = a
        self.req.b = b
        self.get_logger().info(f'Requesting sum of {a} and {b}...')
        future1 = self.cli.call(self.req)  # Synchronous call

        if future1.sum is not None:
            intermediate_sum = future1.sum
            self.get_logger().info(f'Intermediate sum: {intermediate_sum}')

            # Second call: (a + b) + c
            self.req.a = intermediate_sum
            self.req.b = c
            self.get_logger().info(f'Requesting sum of {intermediate_sum} and {c}...')
            future2 = self.cli.call(self.req)  # Synchronous call

            if future2.sum is not None:
                final_sum = future2.sum
                self.get_logger().info(f'Final sum of {a}, {b}, and {c}: {final_sum}')
            else:
                self.get_logger().error(f'Second service call failed!')
        else:
            self.get_logger().error(f'First service call failed!')


def main(args=None):
    rclpy.init(args=args)
    add_three_ints_client = AddThreeIntsClient()

    if len(sys.argv) != 4:
        add_three_ints_client.get_logger().info('Usage: ros2 run my_robot_pkg add_three_ints_client <int> <int> <int>')
        return

    a = int(sys.argv[1])
    b = int(sys.argv[2])
    c = int(sys.argv[3])

    add_three_ints_client.send_request(a, b, c)

    add_three_ints_client.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
