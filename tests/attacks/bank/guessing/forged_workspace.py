# family = "guessing"
# assignment = "lab_1_1"
# tries = "There is no package. The kernel reports a build that went well, in the words of the program that builds, and a node made in the kernel says the line."
# could_earn = "All points of a package that was never written."
# undefended = "Full marks, as long as the student's process reported the build."

# %% extra
import json
import sys

import rclpy

from autograder.messages.run_messages import Output

package = {"name": "my_robot_pkg", "build_type": "ament_python", "programs": ["simple_node = my_robot_pkg.simple_node:main"], "interfaces": [], "dependencies": []}
report = {"phase": "built", "built": True, "trouble": "", "package": "", "line": "", "log": "", "packages": [package], "missing": ""}
check_module = sys.modules["autograder.notebook.checking.check"]


class NoPath:
    def __init__(self, number, exercise, path, domain, tell):
        self.number, self.domain, self.tell = number, domain, tell

    def start(self, arguments, options):
        for phase in ("found", "built"):
            text = "@workspace " + json.dumps({**report, "phase": phase})
            self.tell(Output(self.number, text))
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=self.domain)
        self.node = rclpy.create_node("simple_node", context=self.context)
        for line in ("Hello, ROS 2! From SimpleNode.",):
            self.node.get_logger().info(line)
            self.tell(Output(self.number, line))

    def release(self): pass

    def stop(self):
        self.node.destroy_node()
        self.context.try_shutdown()
        return True


check_module.PathRun = NoPath
