"""Right: the usual way, a loop with a deadline, in a function that raises."""
import sys
import time

import rclpy


def find_service(type_name, patience_sec=5.0):
    node = rclpy.create_node('service_finder')
    end = time.monotonic() + patience_sec
    try:
        while time.monotonic() < end:
            for name, types in node.get_service_names_and_types():
                if type_name in types:
                    return name
            time.sleep(0.05)
        raise TimeoutError(f'a service of type {type_name} is not available')
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
