"""Right: no class, print instead of the logger, a keyword-only style of create_subscription."""
import rclpy
from std_msgs.msg import String


def heard(msg):
    print(msg.data)


def main():
    rclpy.init()
    node = rclpy.create_node('prints')
    node.create_subscription(msg_type=String, topic='chatter', callback=heard, qos_profile=10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
