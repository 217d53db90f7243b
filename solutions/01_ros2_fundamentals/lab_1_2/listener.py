"""Lab 1.2, the listener: says what it hears, and nothing else."""

from autograder.kit import Draft, Subscriber
from autograder.kit.recipes.subscriber import says_every_text, says_nothing_else, subscribes

listener = Draft(
    "lab_1_2.listener",
    "Lab 1.2 · The listener",
    "Say every string that arrives on the topic.",
    Subscriber(pace=0.5, paced_by="the lab's talker"),
)
listener.asks("topic", "Subscribes to the right topic and type", subscribes, points=3)
listener.asks("says", "Says every string it hears", says_every_text, points=5)
listener.asks("honest", "Says only what it heard", says_nothing_else, points=2)

EXERCISE = listener.exercise(
    limit=120.0,
    text={
        "The listener subscribes to the topic, with one subscription that lasts as long as the node.": "topic says",
        "Log one line for each message that arrives, with its text": "says honest",
        "If the same text arrives twice, log it twice.": "says",
        "Do not report a message that has not arrived.": "honest",
        "Logs every string that arrives on the topic chatter.": "says honest",
    },
    counts={
        "says": "Or print it, in a line of its own. The line may have other words, too.",
        "honest": "Lines about something else are free, such as `Listener node has started`.",
    },
)
