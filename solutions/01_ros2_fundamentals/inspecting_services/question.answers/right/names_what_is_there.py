"""Right: where there is none, its error says which services there are."""
import sys
import time

import rclpy


def find_service(type_name, patience_sec=5.0):
    node = rclpy.create_node('service_finder')
    try:
        give_up_at = time.monotonic() + patience_sec
        services = []
        while time.monotonic() < give_up_at:
            services = node.get_service_names_and_types()
            for name, types in services:
                if type_name in types:
                    return name
            time.sleep(0.05)
        seen = ', '.join(name for name, _ in services if 'parameter' not in name)
        raise TimeoutError(f'{type_name} is not available; I see only {seen}')
    finally:
        node.destroy_node()


def main():
    rclpy.init()
    try:
        print(find_service(sys.argv[1]))
    except TimeoutError as problem:
        print(problem)
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
