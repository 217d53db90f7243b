# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.node import Node
from small_robot_interfaces.action import WalkTo
from std_srvs.srv import SetBool


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.lamp = self.create_client(SetBool, "lamp")
        self.walk = ActionClient(self, WalkTo, "walk_to")
        self.goal_handle = None
        self.commands = 0
        self.canceled = False
        self.timer = self.create_timer(0.5, self.drive)

    def drive(self):
        command = Twist()
        command.linear.x = 0.4
        command.angular.z = 1.0
        self.velocity.publish(command)
        self.commands += 1
        if self.commands == 12:
            self.timer.cancel()
            answered = self.lamp.call_async(SetBool.Request(data=True))
            answered.add_done_callback(self.on_lamp)

    def on_lamp(self, answered):
        goal = WalkTo.Goal(x=4.0, y=2.0)
        sent = self.walk.send_goal_async(goal, feedback_callback=self.on_feedback)
        sent.add_done_callback(self.on_goal)

    def on_goal(self, sent):
        self.goal_handle = sent.result()

    def on_feedback(self, message):
        if message.feedback.distance < 1.0 and not self.canceled:
            self.canceled = True
            self.goal_handle.cancel_goal_async()


def main():
    rclpy.init()
    rclpy.spin(Patrol())


if __name__ == "__main__":
    main()
