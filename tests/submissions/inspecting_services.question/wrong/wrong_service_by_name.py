"""Wrong: it believes the name."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
end = time.monotonic() + 5
while time.monotonic() < end:
    for name, types in node.get_service_names_and_types():
        if 'add' in name and not name.startswith('/finder'):
            print(name)
            sys.exit()
    time.sleep(0.05)
print('no service')
