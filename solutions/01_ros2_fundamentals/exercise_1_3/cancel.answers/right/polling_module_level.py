# Right: module level, no class, no main; spin_once loops that look at lists and futures.
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("poller")
client = ActionClient(node, Fibonacci, "/fibonacci")
client.wait_for_server()

feedbacks = []
goal = Fibonacci.Goal()
goal.order = 20
sent = client.send_goal_async(goal, feedback_callback=feedbacks.append)
while not sent.done():
    rclpy.spin_once(node)

handle = sent.result()
assert handle.accepted, "the goal was rejected"
while len(feedbacks) < 5:
    rclpy.spin_once(node)
canceling = handle.cancel_goal_async()
result = handle.get_result_async()
while not result.done():
    rclpy.spin_once(node)
print("Final status: %d" % result.result().status)
