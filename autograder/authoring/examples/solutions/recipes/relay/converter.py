"""A relay: what is heard on one topic is published on another, in another unit."""

from autograder.kit.recipes.relay import NUMBER, Relay


def due(celsius: list[float], before: float = 0.0, after: float = 32.0) -> float:
    """Return what is due after the last of these temperatures."""
    return (celsius[-1] + before) * 9 / 5 + after


task = Relay(
    "relay.converter",
    "A relay · The converter",
    "Publish each temperature that is heard, in degrees Fahrenheit.",
    field="data",
    due=due,
    gives=[0.0, -15.0, NUMBER, NUMBER, NUMBER, NUMBER],
)
task.asks("listens", 1, "Subscribes to the right topic and type", "subscription", "Subscribe to `celsius`")
task.asks("speaks", 1, "Publishes on the right topic and type", "publisher", "on `fahrenheit`")
task.answers("converts", 8, "Publishes each temperature in Fahrenheit", "nine fifths of it, and 32 more")

RIGHT = "Write celsius * 9 / 5 + 32."
task.wrong("offset_forgotten", {"after": 0.0}, "Your node publishes 0 for 0 °C, which is 32 °F.", RIGHT)
task.wrong("offset_multiplied", {"before": 32.0, "after": 0.0}, "Your node multiplies the 32, too.", RIGHT)
task.wrong(
    "not_converted", lambda celsius: celsius[-1], "Your node publishes what it hears, as it is.", RIGHT
)

EXERCISE = task.exercise()
