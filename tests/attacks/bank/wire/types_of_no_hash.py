# family = "wire"
# tries = "In its own memory the talker changes the hash of the type that its publisher announces: a version that does not exist, all bytes set, then none."
# could_earn = "A judge that reads the hash of an endpoint, and ends."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "Nothing: rclpy gives a hash of version 0 for what it cannot read."

# %% right TalkerNode

# %% behind TalkerNode
import ctypes
import mmap

Usual = TalkerNode


class TalkerNode(Usual):
    def __init__(self):
        library = ctypes.CDLL("libstd_msgs__rosidl_generator_c.so")
        hashed = library.std_msgs__msg__String__get_type_hash
        hashed.restype = ctypes.c_void_p
        held = hashed(None)
        page = held & ~(mmap.PAGESIZE - 1)
        ctypes.CDLL(None).mprotect(ctypes.c_void_p(page), 2 * mmap.PAGESIZE, 3)
        for kept in (b"\xff" * 33, b"\0" * 33, b"\xfe" + b"\x01" * 32):
            ctypes.memmove(held, kept, 33)
            if kept[0] == 0xFE:
                super().__init__()
