# Right: the timer is there only while the lamp is on.
import itertools

import rclpy
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("lamp_of_mine")
publisher = node.create_publisher(Int32, "/blink", 10)
numbers = itertools.count(1)
timers = []


def switch(request, response):
    if request.data and not timers:
        timers.append(node.create_timer(0.2, lambda: publisher.publish(Int32(data=next(numbers)))))
    elif not request.data and timers:
        node.destroy_timer(timers.pop())
    response.success, response.message = True, "as you wish"
    return response


node.create_service(SetBool, "lamp", switch)
rclpy.spin(node)
