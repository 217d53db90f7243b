"""Lab 1.2, the talker: a counted greeting on a topic, at a steady rate."""

from __future__ import annotations

from autograder.kit import Draft, Publisher

heard = Publisher()
talker = Draft(
    "lab_1_2.talker",
    "Lab 1.2 · The talker",
    "Publish a counted greeting on the topic every half second.",
    heard,
)
talker.asks("topic", "Publishes on the right topic", heard.on_topic, points=2)
talker.asks("type", "Publishes the right message type", heard.has_type, points=1)
talker.asks("text", "Says the right string", heard.says_text(), points=2)
talker.asks("counter", "Counts up from the start", heard.counts("self.count"), points=2)
talker.asks("rate", "Keeps the rate", heard.keeps_rate, points=3)

EXERCISE = talker.exercise(
    text={
        "The topic of this lab is `chatter`, and its type is `std_msgs/msg/String`.": "topic type",
        "The talker has to publish one message every half second, from the first one on.": "rate",
        "The method does three things: it makes a message, publishes it, and adds one to the count.": "text counter",
        'Says "Hello, world! N" on the topic chatter every 0.5 s; N counts up from 0.': "topic text rate counter",
        "log the string that it publishes": "",
    },
    counts={"rate": "A timer or any other way to keep it."},
)
