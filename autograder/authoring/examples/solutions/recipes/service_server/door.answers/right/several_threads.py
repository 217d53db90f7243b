# Right: several threads, a lock, and no class.
import itertools
import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("entrance")
lock, numbers = threading.Lock(), itertools.count(1)


def answer(request, response):
    with lock:
        return Trigger.Response(success=True, message=f"visitor {next(numbers)}")


node.create_service(Trigger, "/visit", answer, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(4)
executor.add_node(node)
executor.spin()
