# A system clock that runs too fast (a preloaded clock_gettime), and a talker that keeps to real time.
import os
import shutil
import subprocess
import sys
import time

SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <time.h>
static int (*usual)(clockid_t, struct timespec *);
int clock_gettime(clockid_t id, struct timespec *t) {
    static struct timespec first;
    if (!usual) usual = dlsym(RTLD_NEXT, "clock_gettime");
    int r = usual(id, t);
    if (id != CLOCK_REALTIME) return r;
    if (!first.tv_sec) first = *t;
    long long gone = (t->tv_sec - first.tv_sec) * 1000000000LL + t->tv_nsec - first.tv_nsec;
    gone = gone * FACTOR + first.tv_nsec;
    t->tv_sec = first.tv_sec + gone / 1000000000LL;
    t->tv_nsec = gone % 1000000000LL;
    return r;
}
"""
TALKER = """
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
node = Node("talker_node", start_parameter_services=False)
publisher = node.create_publisher(String, "chatter", 10)
while publisher.get_subscription_count() == 0:
    time.sleep(0.01)
for number in range(100):
    publisher.publish(String(data=f"Hello, world! {number}"))
    time.sleep(PAUSE)
"""


def fast_talker(factor, pause):
    """Build a clock that runs so many times too fast, and give the text of a talker that pauses so many seconds."""
    open("shim.c", "w").write(SHIM.replace("FACTOR", factor))
    if shutil.which("cc"):
        subprocess.run(["cc", "-shared", "-fPIC", "-o", "shim.so", "shim.c", "-ldl"], check=True)
    return TALKER.replace("PAUSE", pause)
