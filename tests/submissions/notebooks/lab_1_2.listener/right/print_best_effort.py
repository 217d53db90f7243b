# lab_1_2.listener: print instead of the logger, sensor data QoS, a lambda.

# %% solution ListenerNode
from rclpy.qos import qos_profile_sensor_data


class ListenerNode(Node):
    def __init__(self):
        super().__init__("ears")
        self.create_subscription(String, "/chatter", lambda m: print("->", m.data), qos_profile_sensor_data)
