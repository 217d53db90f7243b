"""Right: the course text's own client, with the interface package's name adapted; it says each second that it waits."""
import sys
import rclpy
from rclpy.node import Node
from rclpy.task import Future
from my_robot_interfaces.srv import AddTwoInts

class AddTwoIntsClient(Node):
    def __init__(self):
        super().__init__('add_two_ints_client')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        # Wait for the service to be available
        while not self.cli.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('service not available, waiting again...')
        self.req = AddTwoInts.Request()
        self.get_logger().info('Add two ints client ready.')

    def send_request(self, a, b):
        self.req.a = a
        self.req.b = b
        self.future = self.cli.call_async(self.req)
        self.get_logger().info(f'Requesting sum of {a} and {b}...')
        return self.future

def main(args=None):
    rclpy.init(args=args)
    add_two_ints_client = AddTwoIntsClient()

    if len(sys.argv) != 3:
        add_two_ints_client.get_logger().info('Usage: ros2 run my_robot_pkg add_client <int> <int>')
        return

    a = int(sys.argv[1])
    b = int(sys.argv[2])

    future = add_two_ints_client.send_request(a, b)

    # Wait for the response
    rclpy.spin_until_future_complete(add_two_ints_client, future)

    if future.result() is not None:
        add_two_ints_client.get_logger().info(f'Result of add_two_ints: {future.result().sum}')
    else:
        add_two_ints_client.get_logger().error(f'Service call failed {future.exception()}')

    add_two_ints_client.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
