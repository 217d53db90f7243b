"""Wrong: it takes the first service that is not about parameters."""
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('finder')
end = time.monotonic() + 5
while time.monotonic() < end:
    found = [n for n, t in node.get_service_names_and_types() if t[0].split('/')[0] in ('std_srvs', 'my_robot_interfaces')]
    if found:
        print(found[0])
        break
    time.sleep(0.05)
