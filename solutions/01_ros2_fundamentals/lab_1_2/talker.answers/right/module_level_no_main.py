# Right: everything at module level, no main, no guard, no shutdown; a lambda, a generator and +.
from itertools import count

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

rclpy.init()
n = Node("n")
p = n.create_publisher(String, "chatter", 100)
numbers = count()
t = n.create_timer(0.5, lambda: p.publish(String(data="Hello, world! " + str(next(numbers)))))
rclpy.spin(n)
