"""A publisher: the battery tells its charge, a number on a topic, at a steady rate."""

from __future__ import annotations

from autograder.kit import Draft, Publisher

heard = Publisher()
battery = Draft(
    "publisher.battery",
    "A publisher · The battery",
    "Publish the charge, 100 percent and one less each time, every 0.5 s.",
    heard,
)
battery.asks("topic", "Publishes on the right topic", heard.on_topic, points=2)
battery.asks("type", "Publishes the right message type", heard.has_type, points=1)
battery.asks("charge", "Counts down from 100", heard.counts("self.charge"), points=4)
battery.asks("rate", "Keeps the rate", heard.keeps_rate, points=3)

EXERCISE = battery.exercise(
    text={
        "Publish on `battery`, as `std_msgs/msg/Int32`": "topic type",
        "beginning with 100 and one less each time": "charge",
        "every 0.5 s": "rate",
    },
)
