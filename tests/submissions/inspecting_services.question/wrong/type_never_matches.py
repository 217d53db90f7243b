"""Wrong: a list is never equal to a text."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
end = time.monotonic() + 4
while time.monotonic() < end:
    for name, types in node.get_service_names_and_types():
        if types == sys.argv[1]:
            print(name)
            sys.exit()
    time.sleep(0.05)
raise TimeoutError('no service of that type')
