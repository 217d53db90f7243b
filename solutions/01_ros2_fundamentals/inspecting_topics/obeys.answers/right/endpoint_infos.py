# Right: looks at the subscriptions of each topic of this type, as `ros2 topic info -v` does.
import time

import rclpy

rclpy.init()
node = rclpy.create_node('looking_at_topics')
found = []
deadline = time.time() + 8
while not found and time.time() < deadline:
    for topic, types in node.get_topic_names_and_types():
        if types == ['geometry_msgs/msg/Twist']:
            ends = node.get_subscriptions_info_by_topic(topic)
            found += [(end.node_name, topic) for end in ends if 'UNKNOWN' not in end.node_name]
    time.sleep(0.1)
if not found:
    raise TimeoutError('no robot obeys')
robot, topic = found[0]
print('I found', {'robot': robot, 'topic': topic})
