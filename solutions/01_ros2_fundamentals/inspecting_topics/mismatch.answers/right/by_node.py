# Right: asks each node, after both were met.
import sys
import time

import rclpy

IGNORED = {'/rosout', '/parameter_events'}


def find_mismatch(talker, listener, patience_sec=8.0):
    node = rclpy.create_node('inspector')
    deadline = time.monotonic() + patience_sec
    try:
        while time.monotonic() < deadline:
            names = [f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces()]
            if talker in names and listener in names:
                published = own(node.get_publisher_names_and_types_by_node(talker[1:], '/'))
                subscribed = own(node.get_subscriber_names_and_types_by_node(listener[1:], '/'))
                if published and subscribed:
                    break
            time.sleep(0.05)
        else:
            raise TimeoutError(f'{talker} or {listener} is not there')
    finally:
        node.destroy_node()
    (topic_published, types_published), = published
    (topic_subscribed, types_subscribed), = subscribed
    return {
        'topic_published': topic_published,
        'topic_subscribed': topic_subscribed,
        'type_published': types_published[0],
        'type_subscribed': types_subscribed[0],
    }


def own(topics):
    return [(name, types) for name, types in topics if name not in IGNORED]


if __name__ == '__main__':
    rclpy.init()
    print(find_mismatch(sys.argv[1], sys.argv[2]))
    rclpy.try_shutdown()
