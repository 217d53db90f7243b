# Right: what the notebook asks for, as a program.
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from small_robot_interfaces.action import WalkTo
from std_srvs.srv import SetBool


class Lamplighter(Node):
    def __init__(self):
        super().__init__("lamplighter")
        self.walk = ActionClient(self, WalkTo, "walk_to")
        self.lamp = self.create_client(SetBool, "lamp")
        self.walk.wait_for_server(timeout_sec=5.0)
        sent = self.walk.send_goal_async(WalkTo.Goal(x=4.0, y=2.0))
        sent.add_done_callback(self.on_goal)

    def on_goal(self, sent):
        goal_handle = sent.result()
        goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_result(self, ended):
        self.lamp.call_async(SetBool.Request(data=True))


rclpy.init()
rclpy.spin(Lamplighter())
