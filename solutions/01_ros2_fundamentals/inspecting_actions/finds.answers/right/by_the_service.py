# Right: an action has a service for its goals, and its node serves that.
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('service_reader')
found = {}
end = time.monotonic() + 8
while not found and time.monotonic() < end:
    for name, namespace in node.get_node_names_and_namespaces():
        for service, types in node.get_service_names_and_types_by_node(name, namespace):
            if service == sys.argv[1] + '/_action/send_goal':
                found = {'node': name, 'type': types[0].removesuffix('_SendGoal')}
    time.sleep(0.1)
print(found)
