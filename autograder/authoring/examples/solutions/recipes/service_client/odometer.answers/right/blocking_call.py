# Right: a blocking call beside a thread that spins.
import sys
import threading

import rclpy
from my_robot_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node("somebody")
client = node.create_client(AddTwoInts, "/add_distances")
threading.Thread(target=rclpy.spin, args=[node], daemon=True).start()
if not client.wait_for_service(4):
    node.get_logger().error("service add_distances not available, I give up")
    sys.exit(1)
answer = client.call(AddTwoInts.Request(a=int(sys.argv[1]), b=int(sys.argv[2])))
node.get_logger().info(f"{answer.sum} in all")
