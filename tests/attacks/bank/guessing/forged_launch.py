# family = "guessing"
# assignment = "exercise_1_1"
# tries = "There is no launch file. Two nodes made in the kernel use the new name in their code, and the kernel reports command lines of processes that were never started."
# could_earn = "All points of a launch file that was never written."
# undefended = "Full marks, as long as the student's process reported what was launched."

# %% extra
import json
import os
import sys
import threading
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from autograder.messages.run_messages import Output

check_module = sys.modules["autograder.notebook.checking.check"]


class NoPath:
    def __init__(self, number, exercise, path, domain, tell):
        self.number, self.domain, self.tell = number, domain, tell

    def start(self, arguments, options):
        for name in ("talker", "listener"):
            argv = [f"/opt/{name}", "--ros-args", "-r", "chatter:=/robot/status_updates"]
            self.tell(Output(self.number, "@process " + json.dumps([os.getpid(), 1, *argv])))
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=self.domain)
        self.executor = SingleThreadedExecutor(context=self.context)
        talker = rclpy.create_node("talker_node", context=self.context)
        publisher = talker.create_publisher(String, "/robot/status_updates", 10)
        talker.create_timer(0.5, lambda: publisher.publish(String(data="Hello, world! 0")))
        listener = rclpy.create_node("listener_node", context=self.context)
        listener.create_subscription(
            String, "/robot/status_updates", lambda m: self.tell(Output(self.number, m.data)), 10
        )
        for node in (talker, listener):
            self.executor.add_node(node)
        threading.Thread(target=self.executor.spin, daemon=True).start()

    def release(self): pass

    def stop(self):
        self.executor.shutdown(timeout_sec=0.5)
        self.context.try_shutdown()
        return True


check_module.PathRun = NoPath
