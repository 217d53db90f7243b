import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_srvs.srv import SetBool


def within(lowest, highest):
    return ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=lowest, to_value=highest)])


class SafeHands(Node):
    def __init__(self):
        super().__init__("safe_hands")
        self.declare_parameter("max_forward", 0.5, within(0.0, 1.0))
        self.declare_parameter("max_turn", 1.0, within(0.0, 2.0))
        self.is_stopped = False
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "agent_vel", self.on_command, 10)
        self.create_service(SetBool, "stop", self.on_stop)
        self.watchdog = self.create_timer(0.5, self.on_silence, autostart=False)

    def on_command(self, command):
        if self.is_stopped:
            return
        forward = self.get_parameter("max_forward").value
        turn = self.get_parameter("max_turn").value
        safe = Twist()
        safe.linear.x = max(-forward, min(forward, command.linear.x))
        safe.angular.z = max(-turn, min(turn, command.angular.z))
        self.publisher.publish(safe)
        self.watchdog.reset()

    def on_silence(self):
        self.watchdog.cancel()
        self.publisher.publish(Twist())

    def on_stop(self, request, response):
        self.is_stopped = request.data
        if request.data:
            self.on_silence()
        response.success = True
        response.message = "stopped" if request.data else "released"
        return response


def main():
    rclpy.init()
    node = SafeHands()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
