"""Right: a timer of one second, reset by each scan, makes the robot blind; the rule is a plain class."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Brain:
    def __init__(self):
        self.state = "driving"
        self.blind = True

    def see(self, front):
        self.blind = False
        if any(distance < 0.5 for distance in front):
            self.state = "turning"
        elif all(distance > 0.8 for distance in front):
            self.state = "driving"

    def decide(self):
        if self.blind:
            return "blind", 0.0, 0.0
        return (self.state, 0.2, 0.0) if self.state == "driving" else (self.state, 0.0, 0.5)


def main():
    rclpy.init()
    node = Node("careful_robot")
    brain = Brain()
    commands = node.create_publisher(Twist, "cmd_vel", 10)
    states = node.create_publisher(String, "state", 10)

    def go_blind():
        brain.blind = True

    dog = node.create_timer(1.0, go_blind)

    def on_scan(scan):
        dog.reset()
        brain.see(scan.ranges[3:6])

    def act():
        state, ahead, turn = brain.decide()
        twist = Twist()
        twist.linear.x = ahead
        twist.angular.z = turn
        commands.publish(twist)
        states.publish(String(data=state))

    node.create_subscription(LaserScan, "scan", on_scan, 10)
    node.create_timer(0.2, act)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
