# A node that starts the talker FAST under the clock of fast_clock, and is made when that one is there.
class TalkerNode(Node):
    def __init__(self):
        super().__init__("starter", start_parameter_services=False)
        environment = {**os.environ, "LD_PRELOAD": os.path.abspath("shim.so")}
        self.fast = subprocess.Popen([sys.executable, "-c", FAST], env=environment)
        until = time.monotonic() + 8.0
        while self.count_publishers("chatter") == 0 and time.monotonic() < until:
            time.sleep(0.05)
