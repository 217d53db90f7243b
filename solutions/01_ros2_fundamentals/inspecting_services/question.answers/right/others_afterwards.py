"""Right: names the service, and then in one line what else there is."""
import sys
import time

import rclpy


def main():
    rclpy.init()
    node = rclpy.create_node('finder')
    end = time.monotonic() + 5
    while time.monotonic() < end:
        services = dict(node.get_service_names_and_types())
        found = [name for name, types in services.items() if sys.argv[1] in types]
        if found:
            print(f'The service of type {sys.argv[1]} is {found[0]}')
            others = [name for name in services if name not in found and 'parameter' not in name]
            print(f'(Of other types: {", ".join(others)})')
            break
        time.sleep(0.1)
    else:
        print(f'Not available: a service of type {sys.argv[1]}')
    rclpy.shutdown()


if __name__ == '__main__':
    main()
