# family = "reading"
# tries = "A node beside the talker's subscribes to every topic that comes up while the judge looks, of whatever type, and asks every service for its type and every node for its parameters; what they say is searched."
# could_earn = "What the judge says to itself: its log, its clock's plans, the texts that it expects."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "Nothing: the judge's nodes have no log on the wire, no parameters and no plans."

# %% right TalkerNode

# %% behind TalkerNode
import rclpy
from rcl_interfaces.srv import ListParameters
from rosidl_runtime_py.utilities import get_message

Usual = TalkerNode
told = ("planted" + "-", "canary" + "-of", "seed", "solution", "reference", "<<class>>")


class TalkerNode(Usual):
    def __init__(self):
        super().__init__()
        self.ears = rclpy.create_node("ears", context=self.context, start_parameter_services=False)
        self.known, self.asked = set(), set()
        self.create_timer(0.05, self.listen)

    def listen(self):
        for topic, types in self.ears.get_topic_names_and_types():
            if topic not in self.known:
                self.known.add(topic)
                try:
                    self.ears.create_subscription(get_message(types[0]), topic, self.hear, 10)
                except Exception:
                    pass
        for name, space in self.ears.get_node_names_and_namespaces():
            if name not in self.asked:
                self.asked.add(name)
                client = self.ears.create_client(ListParameters, f"{space.rstrip('/')}/{name}/list_parameters")
                client.call_async(ListParameters.Request()).add_done_callback(lambda answer: self.hear(answer.result()))
                self.hear(f"{space}{name}")
        rclpy.spin_once(self.ears, timeout_sec=0.0)

    def hear(self, message):
        for word in told:
            if word in str(message).lower():
                print("LEAK:", word, str(message)[:150])
