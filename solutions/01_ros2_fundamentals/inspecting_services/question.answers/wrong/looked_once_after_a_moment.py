"""Wrong: it sleeps for a moment and then looks once."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
time.sleep(0.3)
found = [name for name, types in node.get_service_names_and_types() if sys.argv[1] in types]
print(found[0] if found else 'no such service')
