# family = "breaking"
# tries = "An endless loop that catches every interrupt, with the signals blocked as well."
# could_earn = "A batch that never ends."
# undefended = "The kernel is killed after its grace."

# %% extra
import signal

signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
while True:
    try:
        while True:
            pass
    except BaseException:
        pass
