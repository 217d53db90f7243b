# family = "socket"
# tries = "In one check cell the judge is asked twice: the first time to see the texts that it sends, the second time with a node that says these texts without listening."
# could_earn = "The listener's points with texts learnt by heart."
# earned = { "lab_1_2.listener" = 3 }
# undefended = "Refused: a check counts once. The first conversation counts, with the points for its subscription."

# %% solution ListenerNode
usual, heard = check, []


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", lambda message: heard.append(message.data), 10)


class ByHeart(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", lambda message: None, 10)
        self.create_timer(0.05, lambda: [print(text) for text in heard])


def check(exercise, subject):
    usual(exercise, ListenerNode)
    return usual(exercise, ByHeart)
