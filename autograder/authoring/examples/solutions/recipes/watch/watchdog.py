"""A watch: time alone decides what is due, and the node says each change once."""

from autograder.kit import SameAsSolution, To

BEAT = To("/heartbeat", {})
LOST = (BEAT, 0.7)
"""A heartbeat and 1.45 s of silence. The judge looks after 0.75 s and at the end: far from 1 s and from 1.3 s."""

EXERCISE = SameAsSolution(
    "watch.watchdog",
    "A watch · The watchdog",
    "Say once when the heartbeat is lost, and once when it is back.",
    # The losses fall into different thirds of a second: a node that looks once a second is late for one of them.
    gives=lambda _: [1.0, BEAT, BEAT, *LOST, *LOST, BEAT, *LOST, 2.0, BEAT, BEAT],
    waits=1.5,
    tells={"/alarm": "data"},
    every=True,
    roles=("subscription", "publisher"),
).exercise(
    text={
        "Subscribe to `heartbeat`": "alarm",
        "publishes `String` on `alarm`": "alarm",
        "no heartbeat has come for 1 s": "alarm",
        "when the heartbeat comes again": "alarm",
        "Say each change once, and nothing": "alarm",
    }
)
