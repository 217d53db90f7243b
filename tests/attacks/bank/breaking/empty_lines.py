# family = "breaking"
# tries = "The listener prints empty lines without end, so that the recorder drops the line behind which the scenario reads."
# could_earn = "The exercise's fault in place of zero points."
# earned = { "lab_1_2.listener" = 3 }
# at_most = true
# undefended = "ValueError: tuple.index(x): x not in tuple, no verdict, and the whole lab was blank in each export."

# %% solution ListenerNode
import threading


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", lambda _: None, 10)
        threading.Thread(target=self.prints, daemon=True).start()

    def prints(self):
        for _ in range(2_000):
            print("\n" * 500, end="", flush=True)
            time.sleep(0.01)
