# Right: no limits, which another exercise judges.
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import SetBool


class Hands(Node):
    def __init__(self) -> None:
        super().__init__("safe_hands")
        self.is_stopped = False
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "agent_vel", self.on_command, 10)
        self.create_service(SetBool, "stop", self.on_stop)
        self.watchdog = self.create_timer(0.5, self.on_silence, autostart=False)

    def on_command(self, command: Twist) -> None:
        if not self.is_stopped and math.isfinite(command.linear.x) and math.isfinite(command.angular.z):
            self.publisher.publish(command)
            self.watchdog.reset()

    def on_silence(self) -> None:
        self.watchdog.cancel()
        self.publisher.publish(Twist())

    def on_stop(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self.is_stopped = request.data
        if request.data:
            self.on_silence()
        response.success = True
        return response


rclpy.init()
rclpy.spin(Hands())
