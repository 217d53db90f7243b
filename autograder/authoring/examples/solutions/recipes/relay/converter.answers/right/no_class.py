# Right: no class, and the parameter's changes are told by a callback.
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("thermometer")
publisher = node.create_publisher(Float64, "/fahrenheit", 10)
changes = node.create_publisher(Bool, "/is_on", QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL))
offsets = [node.declare_parameter("offset", 0.0).value]
states = [True]


def changed(parameters):
    offsets.extend(parameter.value for parameter in parameters if parameter.name == "offset")
    return SetParametersResult(successful=True)


def convert(message):
    if message.data == message.data and states[-1]:
        publisher.publish(Float64(data=1.8 * (message.data + offsets[-1]) + 32.0))


def answer(request, _):
    if states[-1] is request.data:
        return SetBool.Response(success=False, message="no change")
    states.append(request.data)
    changes.publish(Bool(data=request.data))
    return SetBool.Response(success=True, message="")


node.add_on_set_parameters_callback(changed)
node.create_subscription(Float64, "/celsius", convert, 10)
node.create_service(SetBool, "/power", answer)
rclpy.spin(node)
