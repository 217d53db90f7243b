# lab_1_2.talker: German names, a QoSProfile, a period from a parameter, imports inside the cell.

# %% solution TalkerNode
from itertools import count

from rclpy.qos import QoSProfile, ReliabilityPolicy


class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("sprecher")
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.RELIABLE)
        self.sender = self.create_publisher(String, "chatter", qos)
        self.zahlen = count()
        periode = self.declare_parameter("periode", 0.5).value
        self.create_timer(periode, lambda: self.sender.publish(String(data=f"Hello, world! {next(self.zahlen)}")))
        self.get_logger().warning("Der Sprecher läuft 📣")
