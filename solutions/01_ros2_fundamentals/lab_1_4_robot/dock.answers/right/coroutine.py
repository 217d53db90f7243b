# Right: a coroutine awaits a timer in place of sleeping, with one thread.
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionServer
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class Dock(Node):
    def __init__(self):
        super().__init__("dock")
        self.ahead = 0.0
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(self, WalkTo, "dock", execute_callback=self.dock)

    def on_scan(self, scan):
        self.ahead = scan.ranges[0]

    async def pause(self, seconds):
        over = Future()
        timer = self.create_timer(seconds, lambda: over.done() or over.set_result(None))
        await over
        self.destroy_timer(timer)

    async def dock(self, goal_handle):
        left = goal_handle.request.x
        if left > self.ahead:
            goal_handle.abort()
            return WalkTo.Result(arrived=False)
        while left > 0.0:
            self.velocity.publish(Twist(linear=Vector3(x=0.5)))
            left -= 0.25
            goal_handle.publish_feedback(WalkTo.Feedback(distance=left))
            await self.pause(0.5)
        self.velocity.publish(Twist())
        goal_handle.succeed()
        return WalkTo.Result(arrived=True)


def main():
    rclpy.init()
    rclpy.spin(Dock())


main()
