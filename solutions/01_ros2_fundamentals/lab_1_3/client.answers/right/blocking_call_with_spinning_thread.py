"""Right: call() while another thread spins."""
import sys
import threading

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
node = rclpy.create_node('asks')
client = node.create_client(AddTwoInts, '/add_two_ints')
executor = SingleThreadedExecutor()
executor.add_node(node)
thread = threading.Thread(target=executor.spin)
thread.start()
try:
    if client.wait_for_service(timeout_sec=4):
        a, b = map(int, sys.argv[1:3])
        print('Summe:', client.call(AddTwoInts.Request(a=b, b=a)).sum)
    else:
        print('Kein Dienst da (not available), ich gebe auf.')
finally:
    executor.shutdown()
    thread.join()
    rclpy.shutdown()
