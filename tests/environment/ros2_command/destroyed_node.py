"""A node was destroyed in a context that goes on: whether another participant takes the graph for settled."""

import sys
import time
from pathlib import Path

import rclpy
from rclpy.context import Context

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from course_runtime.ros2_command.discovery import look

theirs, ours = Context(), Context()
for context in (theirs, ours):
    rclpy.init(context=context)
stays = rclpy.create_node("stays", context=theirs)
rclpy.create_node("goes", context=theirs).destroy_node()
looks = rclpy.create_node("looks", context=ours)

while True:
    names = [name for name, _ in looks.get_topic_names_and_types(no_demangle=True)]
    left = [name for name in names if "goes/get_type_description" in name]
    if left and ("stays", "/") in looks.get_node_names_and_namespaces() and look(looks).named:
        break
    time.sleep(0.01)
print("settled", flush=True)
