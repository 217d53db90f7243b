"""Right: no class, a second for each number, feedback before the first new one."""
import time

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor

rclpy.init()
node = rclpy.create_node('zahlen')


def arbeite(ziel):
    zahlen = [0, 1]
    ziel.publish_feedback(Fibonacci.Feedback(partial_sequence=zahlen))
    for _ in range(ziel.request.order - 1):
        time.sleep(1.0)
        if ziel.is_cancel_requested:
            ziel.canceled()
            node.get_logger().info(f'abgebrochen: {zahlen}')
            return Fibonacci.Result(sequence=zahlen)
        zahlen.append(sum(zahlen[-2:]))
        ziel.publish_feedback(Fibonacci.Feedback(partial_sequence=zahlen))
    ziel.succeed()
    return Fibonacci.Result(sequence=zahlen)


def pruefe(anfrage):
    return GoalResponse.ACCEPT if anfrage.order in range(47) else GoalResponse.REJECT


server = ActionServer(
    node, Fibonacci, '/fibonacci', arbeite,
    goal_callback=pruefe, cancel_callback=lambda ziel: CancelResponse.ACCEPT,
)
executor = MultiThreadedExecutor(num_threads=3)
executor.add_node(node)
executor.spin()
