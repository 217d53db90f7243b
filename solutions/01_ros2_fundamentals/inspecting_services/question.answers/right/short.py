"""Right: no function, a loop with a deadline."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
end = time.monotonic() + 5
while time.monotonic() < end:
    for name, types in node.get_service_names_and_types():
        if sys.argv[1] in types:
            print(name)
            sys.exit()
    time.sleep(0.05)
print('service not available')
