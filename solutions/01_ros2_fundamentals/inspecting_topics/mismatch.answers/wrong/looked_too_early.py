# Wrong: asks for the nodes before they were met.
import sys

import rclpy

rclpy.init()
node = rclpy.create_node('hasty', enable_rosout=False)
talker, listener = (name.lstrip('/') for name in sys.argv[1:3])
# The names of nodes that were never met, as a hasty look finds them.
published = node.get_publisher_names_and_types_by_node(talker + '_', '/')
print({'topic_published': published[0][0]})
