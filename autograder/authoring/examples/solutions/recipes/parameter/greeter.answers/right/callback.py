# Right: is told of each change, under a name of its own, at another pace.
import rclpy
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("somebody")
text = node.declare_parameter("text", "Hello").value


def changed(parameters):
    global text
    for parameter in parameters:
        if parameter.name == "text":
            text = parameter.value
    return SetParametersResult(successful=True)


node.add_on_set_parameters_callback(changed)
publisher = node.create_publisher(String, "greeting", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data=text)))
rclpy.spin(node)
