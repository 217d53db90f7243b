# family = "wire"
# tries = "Every node on the judge's domain is told to change its parameters, use_sim_time first, and every service on it is called."
# could_earn = "A judge whose clock or tolerances the student sets."
# earned = { "lab_1_2.talker" = 7 }
# undefended = "The judge's node has no parameter services, and tolerances are no parameters."

# %% solution TalkerNode
import threading

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.count = 0
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(1.0, self.say_hello)
        self.asked = set()
        self.create_timer(0.05, self.meddle)

    def say_hello(self):
        self.publisher_.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1

    def meddle(self):
        value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=2.0)
        for name in self.get_node_names():
            if name not in self.asked and name != "talker_node":
                self.asked.add(name)
                client = self.create_client(SetParameters, f"/{name}/set_parameters")
                client.call_async(SetParameters.Request(parameters=[Parameter(name="rate_tolerance", value=value)]))
