"""A watchdog, declared: the state that follows from the heartbeats and the time, and wrong ways to tell it."""

from collections.abc import Sequence

from autograder.kit.recipes.watch import SILENCE, Watch
from autograder.kit.rules import Given


def state(beats: Sequence[Given], limit: float = 1.0) -> object:
    """Return what holds: the heartbeat is lost a second after the last one."""
    return "lost" if beats and beats[-1].age >= limit else "back"


SECONDS = (0.3, 0.75, 0.45, 1.65, 1.7, 0.57, 0.4, 2.95, 0.42, 0.25, 2.3)
"""Until the next heartbeat. It is lost four times, in different thirds of a second, once right after it was back."""

task = Watch(
    "watch.watchdog",
    "A watch · The watchdog",
    "Say once when the heartbeat is lost, and once when it is back.",
    state=state,
    gives=[({}, seconds) for seconds in SECONDS],
    within=0.3,
    waits=1.5,
)
task.asks("listens", 1, "Subscribes to the right topic and type", "subscription", "Subscribe to `heartbeat`")
task.asks("speaks", 1, "Publishes on the right topic and type", "publisher", "publishes `String` on `alarm`")
task.says("lost", "lost", 3, "Says lost after a second without a heartbeat", "no heartbeat has come for 1 s")
task.says("back", "back", 3, "Says back when the heartbeat comes again", "when the heartbeat comes again")
task.once("once", 2, "Says each change once", "Say each change once, and nothing")

task.wrong(
    "back_at_first_beat",
    lambda beats: state(beats) if beats else SILENCE,
    "Your node says back at the first heartbeat, though nothing was lost.",
    "Begin in the state in which nothing is lost.",
)
EXERCISE = task.exercise()
