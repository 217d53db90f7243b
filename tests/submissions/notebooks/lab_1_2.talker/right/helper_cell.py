# lab_1_2.talker: the solution needs an extra cell of the student's own; without it there is no talker.

# %% extra
GREETING = "Hello, world! %d"


def numbered(publisher, number):
    """Publish the greeting with its number."""
    publisher.publish(String(data=GREETING % number))

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_with_helper")
        self.count = 0
        self.publisher = self.create_publisher(String, "/chatter", 10)
        self.create_timer(1 / 2, self.talk)

    def talk(self):
        numbered(self.publisher, self.count)
        self.count += 1
