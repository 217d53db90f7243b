"""Wrong: adds up without ROS."""
import sys

a, b = int(sys.argv[1]), int(sys.argv[2])
print(f'[INFO] [add_two_ints_client]: Result of add_two_ints: {a + b}')
