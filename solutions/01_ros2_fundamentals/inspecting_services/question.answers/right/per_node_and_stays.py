"""Right: asks node by node, and goes on spinning once it has named the service."""
import sys
import time

import rclpy


def look(node, wanted):
    for name, namespace in node.get_node_names_and_namespaces():
        try:
            offered = node.get_service_names_and_types_by_node(name, namespace)
        except Exception:
            continue
        for service, types in offered:
            if wanted in types:
                return service
    return None


def main():
    rclpy.init()
    node = rclpy.create_node('per_node')
    end = time.monotonic() + 5
    found = None
    while found is None and time.monotonic() < end:
        found = look(node, sys.argv[1])
        rclpy.spin_once(node, timeout_sec=0.05)
    if found is None:
        sys.exit('none of that type: not available')
    print(found, flush=True)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
