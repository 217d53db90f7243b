"""Right: takes a moment for each answer and says nothing."""
import time

import rclpy
from my_robot_interfaces.srv import AddTwoInts


def add(request, response):
    time.sleep(0.1)
    response.sum = int(request.a) + int(request.b)
    return response


def main():
    rclpy.init()
    node = rclpy.create_node('slow_adder')
    node.create_service(AddTwoInts, 'add_two_ints', add)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
