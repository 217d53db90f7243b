"""Right: no class, no main, a lambda that returns a response of its own."""
import rclpy
from my_robot_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node('adder')
service = node.create_service(
    AddTwoInts, '/add_two_ints', lambda request, _: AddTwoInts.Response(sum=request.a + request.b)
)
rclpy.spin(node)
