# Right: a dictionary, lambdas, no class, and a message in the response.
import rclpy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("scales_of_mine")
publisher = node.create_publisher(Int32, "/total", 1)
weights = {}
offset = [0]


def hear(side, message):
    weights[side] = message.data
    if len(weights) == 2:
        publisher.publish(Int32(data=sum(weights.values()) - offset[0]))


for side in ("/right", "/left"):
    node.create_subscription(Int32, side, lambda message, side=side: hear(side, message), 1)


def tare(request, response):
    try:
        offset[0] = weights["/left"] + weights["/right"]
    except KeyError as error:
        response.success, response.message = False, f"nothing from {error}"
    else:
        response.success, response.message = True, f"{offset[0]} g"
    return response


node.create_service(Trigger, "/tare", tare)
rclpy.spin(node)
