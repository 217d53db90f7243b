# family = "wire"
# assignment = "lab_1_3"
# tries = "Requests come from a publisher on the topic behind the judge's service, whose prefix is changed in the kernel's own memory: bytes that are no request, and requests of a client that does not exist, which waits for no answer."
# could_earn = "A judge that breaks down over a request, or waits for a client that will never take its answer."
# earned = { "lab_1_3.client" = 10 }
# at_most = true
# undefended = "A request that cannot be read is dropped; an answer to nobody is tried for three seconds."
# says = "reaches 1 service"

# %% right add_two_ints

# %% behind add_two_ints
import ctypes
import mmap
import time

honest, library = add_two_ints, ctypes.CDLL("librmw_fastrtps_shared_cpp.so")


def publisher_behind_the_service(node):
    prefix = ctypes.c_char_p.in_dll(library, "ros_topic_prefix")
    page = ctypes.addressof(prefix) & ~(mmap.PAGESIZE - 1)
    ctypes.CDLL(None).mprotect(ctypes.c_void_p(page), mmap.PAGESIZE, 3)
    usual, prefix.value = prefix.value, b"rq"
    try:
        return node.create_publisher(AddTwoInts.Request, "add_two_intsRequest", 100)
    finally:
        prefix.value = usual


def add_two_ints(a: int, b: int, patience_sec: float = 5.0) -> int:
    node = rclpy.create_node("writes_by_itself")
    publisher, head = publisher_behind_the_service(node), b"\0\1\0\0"
    end = time.monotonic() + 1.0
    while time.monotonic() < end and not publisher.get_subscription_count():
        time.sleep(0.01)
    print("reaches", publisher.get_subscription_count(), "service")
    for odd in (b"\1\2\3", b"", b"\xff" * 15, b"\xff" * 16, a.to_bytes(8, "little", signed=True) * 2) * 4:
        publisher.publish(head + odd)
    try:
        return honest(a, b, patience_sec)
    finally:
        node.destroy_node()
