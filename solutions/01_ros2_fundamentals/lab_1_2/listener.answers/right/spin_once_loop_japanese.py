"""Right: a spin_once loop, Japanese log lines, an error level for no reason."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class 聞き手(Node):
    def __init__(self):
        super().__init__('kikite')
        self.create_subscription(String, 'chatter', self.聞く, 10)

    def 聞く(self, メッセージ):
        self.get_logger().error(f'「{メッセージ.data}」と聞こえました 👂')


rclpy.init()
節 = 聞き手()
while rclpy.ok():
    rclpy.spin_once(節, timeout_sec=0.2)
