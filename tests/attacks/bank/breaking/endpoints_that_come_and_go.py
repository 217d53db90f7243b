# family = "breaking"
# tries = "Beside a right talker, two threads make and destroy nodes without a pause, each time with the same names and other types: publishers, subscriptions, services and clients, also on the talker's topic and under the talker's name."
# could_earn = "A judge that ends because what it has just seen on the graph is gone, or has another type, when it asks for it."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "Nothing in one run: without the judge's answer to a node that goes between two queries it was not lost, either."

# %% right TalkerNode

# %% behind TalkerNode
import itertools
import threading

import rclpy
from rclpy.context import Context
from std_msgs.msg import Int32
from std_srvs.srv import Empty, SetBool, Trigger

Usual = TalkerNode


def come_and_go(name, until):
    context = Context()
    context.init(domain_id=rclpy.utilities.get_default_context().get_domain_id())
    for kind, served in zip(itertools.cycle((Int32, String)), itertools.cycle((Empty, SetBool, Trigger))):
        node = Node(name, context=context, start_parameter_services=False)
        node.create_publisher(kind, "chatter", 10)
        node.create_subscription(kind, "chatter", lambda _: None, 1)
        node.create_service(served, "goes", lambda _, response: response)
        node.create_client(served, "goes")
        time.sleep(0.002)
        node.destroy_node()
        if time.monotonic() > until:
            return context.shutdown()


class TalkerNode(Usual):
    def __init__(self):
        super().__init__()
        for name in ("goes", self.get_name()):
            threading.Thread(target=come_and_go, args=(name, time.monotonic() + 20.0), daemon=True).start()
