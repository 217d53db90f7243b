"""Right: a background thread spins; the node has another service and a topic beside it."""
import threading

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from std_msgs.msg import Int64
from std_srvs.srv import Trigger


def main():
    rclpy.init()
    node = rclpy.create_node('adder', namespace='robot')
    last = node.create_publisher(Int64, 'last_sum', 10)

    def add(request, response):
        response.sum = request.b + request.a
        last.publish(Int64(data=response.sum))
        return response

    def status(_, response):
        response.success = True
        return response

    node.create_service(AddTwoInts, '/add_two_ints', add)
    node.create_service(Trigger, 'status', status)
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    try:
        thread.join()
    except KeyboardInterrupt:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
