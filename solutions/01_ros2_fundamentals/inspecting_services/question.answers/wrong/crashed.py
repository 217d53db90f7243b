"""Wrong: the pairs are not a dictionary."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
for name in node.get_service_names_and_types().keys():
    print(name)
