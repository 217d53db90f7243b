# family = "wire"
# tries = "Eight publishers fill the judge's queue with messages of eight megabytes, faster than anybody can read them."
# could_earn = "A host without memory, through the judge, whose box has other limits than the student's."
# earned = { "lab_1_2.talker" = 3 }
# at_most = true
# undefended = "A judge that kept a thousand messages of any size would need eight gigabytes."

# %% solution TalkerNode
import threading


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        message = String(data="x" * 8_000_000)
        for _ in range(8):
            publisher = self.create_publisher(String, "chatter", 10)

            def flood(publisher=publisher, until=time.monotonic() + 8.0):
                while time.monotonic() < until:
                    try:
                        publisher.publish(message)
                    except Exception:
                        return

            threading.Thread(target=flood, daemon=True).start()
