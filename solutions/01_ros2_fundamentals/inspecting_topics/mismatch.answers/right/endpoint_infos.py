# Right: looks at every topic's endpoints for the two nodes, as `ros2 topic info -v` does.
import sys
import time

import rclpy

rclpy.init()
node = rclpy.create_node('looking_at_topics')
talker, listener = (name.lstrip('/') for name in sys.argv[1:3])
found = {}
deadline = time.time() + 8
while len(found) < 4 and time.time() < deadline:
    for topic, _ in node.get_topic_names_and_types():
        if topic in ('/rosout', '/parameter_events'):
            continue
        for info in node.get_publishers_info_by_topic(topic):
            if info.node_name == talker:
                found['topic_published'], found['type_published'] = topic, info.topic_type
        for info in node.get_subscriptions_info_by_topic(topic):
            if info.node_name == listener:
                found['topic_subscribed'], found['type_subscribed'] = topic, info.topic_type
    rclpy.spin_once(node, timeout_sec=0.1)
print('This is what I found:', found)
