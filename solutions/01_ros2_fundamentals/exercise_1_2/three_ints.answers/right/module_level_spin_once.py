# Right: no main, no class; a spin_once loop until the future is done; prints the bare number.
import sys
import rclpy
from my_robot_interfaces.srv import AddTwoInts

rclpy.init()
n = rclpy.create_node("n")
adder = n.create_client(AddTwoInts, "add_two_ints")
if not adder.wait_for_service(6):
    sys.exit("timed out: add_two_ints not available")

total = int(sys.argv[1])
for word in sys.argv[2:]:
    request = AddTwoInts.Request()
    request.a, request.b = total, int(word)
    future = adder.call_async(request)
    while not future.done():
        rclpy.spin_once(n)
    total = future.result().sum
print(total)
