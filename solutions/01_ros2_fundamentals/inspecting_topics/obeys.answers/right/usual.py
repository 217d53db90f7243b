# Right: asks each node for its subscriptions.
import time

import rclpy

TWIST = 'geometry_msgs/msg/Twist'


def find_robot():
    node = rclpy.create_node('scout')
    give_up_at = time.monotonic() + 8.0
    try:
        while time.monotonic() < give_up_at:
            for name, namespace in node.get_node_names_and_namespaces():
                for topic, types in node.get_subscriber_names_and_types_by_node(name, namespace):
                    if TWIST in types:
                        return {'robot': name, 'topic': topic}
            time.sleep(0.05)
        raise TimeoutError('no node obeys a Twist')
    finally:
        node.destroy_node()


if __name__ == '__main__':
    rclpy.init()
    print(find_robot())
    rclpy.try_shutdown()
