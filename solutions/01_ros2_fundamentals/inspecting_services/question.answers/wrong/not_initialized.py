"""Wrong: it makes its node before ROS is started."""
import sys

import rclpy

node = rclpy.create_node('finder')
rclpy.init()
print([name for name, types in node.get_service_names_and_types() if sys.argv[1] in types])
