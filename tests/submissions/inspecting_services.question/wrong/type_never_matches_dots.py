"""Wrong: a type is not written with dots."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
wanted = sys.argv[1].replace('/', '.')
end = time.monotonic() + 4
while time.monotonic() < end:
    for name, types in node.get_service_names_and_types():
        if wanted in types:
            print(name)
            sys.exit()
    time.sleep(0.05)
print('no service of that type')
