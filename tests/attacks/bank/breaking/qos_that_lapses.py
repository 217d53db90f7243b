# family = "breaking"
# tries = "The talker is right, but its publisher promises a message each nanosecond and a sign of life each millisecond, gives neither, and its messages expire at once."
# could_earn = "A judge that drowns in the events of broken promises."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "The judge asks for no promise, so it hears of none."

# %% right TalkerNode

# %% behind TalkerNode
from rclpy.duration import Duration
from rclpy.qos import LivelinessPolicy, QoSProfile

Usual, Bare = TalkerNode, Node.create_publisher
LAPSES = QoSProfile(
    depth=1,
    deadline=Duration(nanoseconds=1),
    lifespan=Duration(nanoseconds=1),
    liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
    liveliness_lease_duration=Duration(nanoseconds=1_000_000),
)


class TalkerNode(Usual):
    def create_publisher(self, kind, topic, qos, **more):
        return Bare(self, kind, topic, LAPSES if topic == "chatter" else qos, **more)
