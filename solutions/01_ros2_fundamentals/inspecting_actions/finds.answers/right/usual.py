# Right: asks each node for the actions that it serves.
import sys
import time

import rclpy
from rclpy.action import get_action_server_names_and_types_by_node


def find_server(action):
    node = rclpy.create_node('scout')
    give_up_at = time.monotonic() + 8.0
    try:
        while time.monotonic() < give_up_at:
            for name, namespace in node.get_node_names_and_namespaces():
                for served, types in get_action_server_names_and_types_by_node(node, name, namespace):
                    if served == action:
                        return {'node': name, 'type': types[0]}
            time.sleep(0.05)
        raise TimeoutError(f'no node serves {action}')
    finally:
        node.destroy_node()


if __name__ == '__main__':
    rclpy.init()
    print(find_server(sys.argv[1]))
    rclpy.try_shutdown()
