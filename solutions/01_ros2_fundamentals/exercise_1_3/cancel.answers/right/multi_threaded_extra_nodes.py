"""Right: several threads, a reentrant group, a second node that chats; asks for the result only after the cancel."""
import time

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32


class Worker(Node):
    def __init__(self):
        super().__init__('worker')
        group = ReentrantCallbackGroup()
        self.progress = self.create_publisher(Int32, 'progress', 10)
        self.client = ActionClient(self, Fibonacci, 'fibonacci', callback_group=group)
        self.start = self.create_timer(0.01, self.work, callback_group=group)
        self.count = 0
        self.over = False

    def on_feedback(self, msg):
        self.count += 1
        self.progress.publish(Int32(data=len(msg.feedback.partial_sequence)))

    def work(self):
        self.start.cancel()
        self.client.wait_for_server(timeout_sec=10.0)
        sending = self.client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=self.on_feedback)
        while not sending.done() or (sending.result().accepted and self.count < 3):
            time.sleep(0.002)
        goal = sending.result()
        if not goal.accepted:
            self.get_logger().warning('no such luck: the goal was rejected')
            self.over = True
            return
        goal.cancel_goal()
        status = goal.get_result().status
        self.get_logger().info(f'{status=} canceled={status == GoalStatus.STATUS_CANCELED}')
        self.over = True


rclpy.init()
executor = MultiThreadedExecutor(num_threads=4)
worker, chatterbox = Worker(), Node('chatterbox')
chatterbox.create_timer(0.4, lambda: chatterbox.get_logger().info('lovely weather'))
executor.add_node(worker)
executor.add_node(chatterbox)
while not worker.over:
    executor.spin_once(timeout_sec=0.1)
executor.shutdown()
rclpy.shutdown()
