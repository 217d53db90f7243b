# Right: a sequence in main, with loops, sleeps and a spin for each answer; it lives in real time.
import time

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionClient
from small_robot_interfaces.action import WalkTo
from std_srvs.srv import SetBool

LIMIT = 30.0


def main():
    rclpy.init()
    node = rclpy.create_node("night_watch")
    velocity = node.create_publisher(Twist, "cmd_vel", 10)
    lamp = node.create_client(SetBool, "lamp")
    walk = ActionClient(node, WalkTo, "walk_to")
    lamp.wait_for_service(timeout_sec=10.0)
    walk.wait_for_server(timeout_sec=10.0)
    while velocity.get_subscription_count() == 0:
        time.sleep(0.05)

    for _ in range(12):
        velocity.publish(Twist(linear=Vector3(x=0.4), angular=Vector3(z=1.0)))
        time.sleep(0.5)

    rclpy.spin_until_future_complete(node, lamp.call_async(SetBool.Request(data=True)), timeout_sec=LIMIT)

    left = [100.0]
    sent = walk.send_goal_async(
        WalkTo.Goal(x=4.0, y=2.0),
        feedback_callback=lambda message: left.append(message.feedback.distance),
    )
    rclpy.spin_until_future_complete(node, sent, timeout_sec=LIMIT)
    handle = sent.result()
    while left[-1] >= 1.0:
        rclpy.spin_once(node, timeout_sec=1.0)
    rclpy.spin_until_future_complete(node, handle.cancel_goal_async(), timeout_sec=LIMIT)
    rclpy.spin_until_future_complete(node, handle.get_result_async(), timeout_sec=LIMIT)
    rclpy.shutdown()


main()
