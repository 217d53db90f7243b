# Right: what the notebook asks for, as one class.
import math

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_srvs.srv import SetBool


def within(lowest: float, highest: float) -> ParameterDescriptor:
    """Return the descriptor of a decimal number in a range."""
    return ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=lowest, to_value=highest)]
    )


class FiniteHands(Node):
    """Takes only commands whose numbers are finite, and keeps limits, a watchdog and a red button."""

    def __init__(self) -> None:
        super().__init__("safe_hands")
        self.declare_parameter("max_forward", 0.5, within(0.0, 1.0))
        self.declare_parameter("max_turn", 1.0, within(0.0, 2.0))
        self.is_stopped = False
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "agent_vel", self.on_command, 10)
        self.create_service(SetBool, "stop", self.on_stop)
        self.watchdog = self.create_timer(0.5, self.on_silence, autostart=False)

    def on_command(self, command: Twist) -> None:
        """Hand a command on, if both of its numbers are finite."""
        if math.isfinite(command.linear.x) and math.isfinite(command.angular.z):
            self.hand_on(command)

    def hand_on(self, command: Twist) -> None:
        """Hand a command on within the limits, unless the stop holds."""
        if self.is_stopped:
            return
        forward = self.get_parameter("max_forward").value
        turn = self.get_parameter("max_turn").value
        safe = Twist()
        safe.linear.x = max(-forward, min(forward, command.linear.x))
        safe.angular.z = max(-turn, min(turn, command.angular.z))
        self.publisher.publish(safe)
        self.watchdog.reset()

    def on_silence(self) -> None:
        """Stop the robot once."""
        self.watchdog.cancel()
        self.publisher.publish(Twist())

    def on_stop(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Stop the robot, or release it."""
        self.is_stopped = request.data
        if request.data:
            self.on_silence()
        response.success = True
        response.message = "stopped" if request.data else "released"
        return response


rclpy.init()
rclpy.spin(FiniteHands())
