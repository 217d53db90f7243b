# family = "wire"
# tries = "The talker is a process whose system clock runs 2.3 times too fast (a preloaded clock_gettime), so that its messages say that they were sent half a second apart while they come every 0.22 s; it keeps to real time."
# could_earn = "The three points for the rate."
# earned = { "lab_1_2.talker" = 7 }
# at_most = true
# undefended = "Full marks, as long as messages had to arrive over no more than 0.4 of the time over which they were sent."

# %% extra
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
    gone = gone * 23 / 10 + first.tv_nsec;
    t->tv_sec = first.tv_sec + gone / 1000000000LL;
    t->tv_nsec = gone % 1000000000LL;
    return r;
}
"""
FAST = """
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
    time.sleep(0.5 / 2.3)
"""
open("shim.c", "w").write(SHIM)
if shutil.which("cc"):
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "shim.so", "shim.c", "-ldl"], check=True)

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("starter", start_parameter_services=False)
        environment = {**os.environ, "LD_PRELOAD": os.path.abspath("shim.so")}
        self.fast = subprocess.Popen([sys.executable, "-c", FAST], env=environment)
        until = time.monotonic() + 8.0
        while self.count_publishers("chatter") == 0 and time.monotonic() < until:
            time.sleep(0.05)
