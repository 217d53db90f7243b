# family = "breaking"
# tries = "The talker changes its node's name in its own memory to bytes that are no text, and announces the node again."
# could_earn = "A judge that ends without a verdict in place of zero points."
# undefended = "rclpy could not read the names on the graph, the judge's child ended with code 1, and each run of grade tried again."

# %% solution TalkerNode
import re

MARKED = b"marked_" + b"z" * 40


class TalkerNode(Node):
    def __init__(self):
        super().__init__(MARKED.decode())
        again = self.create_publisher(String, "again", 10)
        with open("/proc/self/maps") as maps, open("/proc/self/mem", "rb+", buffering=0) as memory:
            for begin, end in re.findall(r"(?m)^(\w+)-(\w+) rw", maps.read()):
                begin, end = int(begin, 16), int(end, 16)
                try:
                    memory.seek(begin)
                    held = memory.read(min(end - begin, 100_000_000))
                    for found in re.finditer(re.escape(MARKED) + rb"\0", held):
                        memory.seek(begin + found.start())
                        memory.write(b"\xff\xfe")
                except (OSError, ValueError):
                    continue
        self.destroy_publisher(again)
