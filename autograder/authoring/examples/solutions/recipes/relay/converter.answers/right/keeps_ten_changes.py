# Right: keeps ten changes for late listeners, of which the last is the newest; best effort, as sensors are.
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("keeper")
node.declare_parameter("offset", 0.0)
fahrenheit = node.create_publisher(Float64, "fahrenheit", 10)
changes = node.create_publisher(Bool, "is_on", QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))
converter = []


def convert(message):
    if message.data != message.data:
        return
    out = Float64()
    out.data = (message.data + node.get_parameter("offset").value) * 9.0 / 5.0 + 32.0
    fahrenheit.publish(out)


def switch(request, response):
    response.success = request.data != bool(converter)
    if not response.success:
        response.message = "it is so already"
    elif request.data:
        listen()
    else:
        node.destroy_subscription(converter.pop())
    if response.success:
        changes.publish(Bool(data=request.data))
    return response


def listen():
    converter.append(node.create_subscription(Float64, "celsius", convert, qos_profile_sensor_data))


listen()
node.create_service(SetBool, "power", switch)
rclpy.spin(node)
