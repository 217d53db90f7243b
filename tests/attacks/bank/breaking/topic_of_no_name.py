# family = "breaking"
# tries = "The talker changes its topic's name and type in its own memory to bytes that are no text and no name, and announces them."
# could_earn = "A judge that ends without a verdict in place of zero points."
# earned = { "lab_1_2.talker" = 3 }
# at_most = true
# undefended = "Zero points: the judge sees no topic of the right name."

# %% solution TalkerNode
import re

MARKED = b"marked_" + b"z" * 40


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.odd = self.create_publisher(String, MARKED.decode(), 10)
        with open("/proc/self/maps") as maps, open("/proc/self/mem", "rb+", buffering=0) as memory:
            for begin, end in re.findall(r"(?m)^(\w+)-(\w+) rw", maps.read()):
                begin, end = int(begin, 16), int(end, 16)
                try:
                    memory.seek(begin)
                    held = memory.read(min(end - begin, 100_000_000))
                    for found in re.finditer(re.escape(b"rt/" + MARKED) + rb"|std_msgs::msg::dds_::String_", held):
                        memory.seek(begin + found.start())
                        memory.write(b"rt/\xff\xfe//\x1b[2J~{" if found[0].startswith(b"rt") else b"std_msgs:::\xff\xfe")
                except (OSError, ValueError):
                    continue
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, lambda: self.publisher.publish(String(data="Hello, world! 0")))
