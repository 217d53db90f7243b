"""Right: the sum stands at the end of a row of dots."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node('bill')
client = node.create_client(AddTwoInts, 'add_two_ints')
if not client.wait_for_service(timeout_sec=5.0):
    sys.exit('service not available')
total, *rest = map(int, sys.argv[1:])
for number in rest:
    future = client.call_async(AddTwoInts.Request(a=total, b=number))
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    if not future.done():
        sys.exit('no answer')
    total = future.result().sum
print('Total'.ljust(30, '.') + str(total))
rclpy.shutdown()
