"""A publisher: the battery tells its charge, a number on a topic, at a steady rate."""

from __future__ import annotations

from autograder.kit.draft import Draft
from autograder.kit.recipes.publisher import Hears

heard = Hears()
battery = Draft(
    "publisher.battery",
    "A publisher · The battery",
    "Publish the charge, 100 percent and one less each time, every 0.5 s.",
    heard,
)
battery.asks("topic", 2, "Publishes on the right topic", heard.on_topic)
battery.asks("type", 1, "Publishes the right message type", heard.has_type)
battery.asks("charge", 4, "Counts down from 100", heard.counts("self.charge"))
battery.asks("rate", 3, "Keeps the rate", heard.keeps_rate)

EXERCISE = battery.exercise(
    text={
        "Publish on `battery`, as `std_msgs/msg/Int32`": "topic type",
        "beginning with 100 and one less each time": "charge",
        "every 0.5 s": "rate",
    },
)
