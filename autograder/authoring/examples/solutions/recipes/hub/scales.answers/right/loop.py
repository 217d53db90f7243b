# Right: a spin_once loop without callbacks' work; tells in the loop.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


def main():
    rclpy.init()
    node = Node("scales")
    total = node.create_publisher(Int32, "total", 10)
    state = {"left": None, "right": None, "zero": 0}
    fresh = []

    def hear(side):
        def on_message(message: Int32) -> None:
            state[side] = message.data
            fresh.append((state["left"], state["right"], state["zero"]))

        return on_message

    def on_tare(request, response):
        if state["left"] is None or state["right"] is None:
            response.message = "no load"
            response.success = False
        else:
            state["zero"] = state["left"] + state["right"]
            response.success = True
        return response

    node.create_subscription(Int32, "left", hear("left"), 10)
    node.create_subscription(Int32, "right", hear("right"), 10)
    node.create_service(Trigger, "tare", on_tare)
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.02)
        while fresh:
            left, right, zero = fresh.pop(0)
            if left is not None and right is not None:
                total.publish(Int32(data=left + right - zero))


if __name__ == "__main__":
    main()
