# Right: waits for the service and for the answer, each with a limit.
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node("odometer")
client = node.create_client(AddTwoInts, "add_distances")
if not client.wait_for_service(timeout_sec=5.0):
    sys.exit("add_distances is not available")
request = AddTwoInts.Request()
request.a, request.b = int(sys.argv[1]), int(sys.argv[2])
future = client.call_async(request)
rclpy.spin_until_future_complete(node, future)
print("together:", future.result().sum)
