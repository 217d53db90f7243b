# Right: two nodes; the weights go through a queue to a thread that publishes.
import queue
import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

rclpy.init()
scales = rclpy.create_node("scales", namespace="lab")
desk = rclpy.create_node("desk")
jobs = queue.Queue()
weights, zero = {}, 0
total = desk.create_publisher(Int32, "total", QoSProfile(depth=5, reliability=ReliabilityPolicy.RELIABLE))
scales.create_subscription(Int32, "/left", lambda m: jobs.put(("left", m.data)), 5)
scales.create_subscription(Int32, "/right", lambda m: jobs.put(("right", m.data)), 5)


def work():
    global zero
    while True:
        job, value = jobs.get()
        if job == "tare":
            ok = len(weights) == 2
            if ok:
                zero = sum(weights.values())
            value.put(ok)
            continue
        weights[job] = value
        if len(weights) == 2:
            total.publish(Int32(data=sum(weights.values()) - zero))


def tare(request, response):
    answer = queue.Queue()
    jobs.put(("tare", answer))
    response.success = answer.get()
    return response


desk.create_service(Trigger, "/tare", tare)
threading.Thread(target=work, daemon=True).start()
executor = SingleThreadedExecutor()
executor.add_node(scales)
executor.add_node(desk)
executor.spin()
