# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node


def within(lowest: float, highest: float) -> ParameterDescriptor:
    """Return the descriptor of a decimal number in a range."""
    return ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=lowest, to_value=highest)]
    )


class Hands(Node):
    """Hands each command of an agent on to the robot."""

    def __init__(self) -> None:
        super().__init__("safe_hands")
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "agent_vel", self.on_command, 10)
        self.declare_parameter("max_forward", 0.5, within(0.0, 1.0))
        self.declare_parameter("max_turn", 1.0, within(0.0, 2.0))

    def on_command(self, command: Twist) -> None:
        """Hand a command on."""
        self.publisher.publish(self.limited(command))

    def limited(self, command: Twist) -> Twist:
        """Return the command that the robot gets."""
        return command


class LimitedHands(Hands):
    """Hands commands on, within the limits that hold at the moment."""

    def limited(self, command: Twist) -> Twist:
        """Return the command, within the limits."""
        forward = self.get_parameter("max_forward").value
        turn = self.get_parameter("max_turn").value
        safe = Twist()
        safe.linear.x = max(-forward, min(forward, command.linear.x))
        safe.angular.z = max(-turn, min(turn, command.angular.z))
        return safe


class WatchfulHands(LimitedHands):
    """Stops the robot when no command has come for half a second."""

    def __init__(self) -> None:
        super().__init__()
        self.watchdog = self.create_timer(0.5, self.on_silence)
        self.watchdog.cancel()

    def on_command(self, command: Twist) -> None:
        """Hand a command on, and set the watchdog back."""
        super().on_command(command)
        self.watchdog.reset()

    def on_silence(self) -> None:
        """Stop the robot once."""
        self.watchdog.cancel()
        self.publisher.publish(Twist())


rclpy.init()
rclpy.spin(WatchfulHands())
