# Right: what the notebook asks for, as a program.
import itertools
import sys
import time

import rclpy
from rclpy.qos import QoSCompatibility, qos_check_compatible


def find_deaf(topic: str) -> str:
    """Return the name of the node that cannot hear what is published on a topic."""
    scout = rclpy.create_node("scout")
    give_up_at = time.monotonic() + 8.0
    try:
        while time.monotonic() < give_up_at:
            publishers = scout.get_publishers_info_by_topic(topic)
            found = scout.get_subscriptions_info_by_topic(topic)
            subscribers = [end for end in found if "UNKNOWN" not in end.node_name]
            for talks, hears in itertools.product(publishers, subscribers):
                fits = qos_check_compatible(talks.qos_profile, hears.qos_profile)[0]
                if fits == QoSCompatibility.ERROR:
                    return hears.node_name
            time.sleep(0.1)
        raise TimeoutError(f"all who listen to {topic} can hear")
    finally:
        scout.destroy_node()


rclpy.init()
print(find_deaf(sys.argv[1]))
