# family = "breaking"
# tries = "Texts in which the kernel's own memory holds bytes of no letter come everywhere where a text may: in messages, in the log, in lines that are printed, in the names of threads and of the callback, and in the exception that ends it."
# could_earn = "A judge or a link that ends over a text which cannot be decoded, so that the zero becomes no grade."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "A line that is no text is no line of the conversation, and rclpy decodes messages with a replacement."
# says = "ted 3"

# %% right TalkerNode

# %% behind TalkerNode
import ctypes
import itertools
import sys
import threading

Usual, turns = TalkerNode, itertools.count()


def spoilt(text):
    """A new text that Python takes for ASCII, with bytes in it that are none."""
    text = "".join(list(text))
    ctypes.memmove(id(text) + sys.getsizeof("") - 1, b"\xff\xfe\xed\xa0", 4)
    return text


class TalkerNode(Usual):
    def __init__(self):
        super().__init__()
        self.noise = self.create_publisher(String, "noise", 10)
        self.create_timer(0.3, self.spoil)

    def spoil(self):
        turn = next(turns)
        self.get_logger().info(spoilt(f"heard it {turn}"))
        print(spoilt(f"printed {turn}"), flush=True)
        print(spoilt(f"complained {turn}"), file=sys.stderr, flush=True)
        threading.current_thread().name = spoilt("named it")
        self.noise.publish(String(data=spoilt("a noise")))
        if turn > 4:
            self.publisher.publish(String(data=spoilt(f"Hello, world! {turn}")))
        if turn > 8:
            failing = self.spoil.__func__.__code__.replace(co_name=spoilt("failing"))
            print(failing.co_name)
            raise ValueError(spoilt("ended here"))
