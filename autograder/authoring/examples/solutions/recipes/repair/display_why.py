"""A question on the cause: the card lists the choices, for each student in another order."""

from autograder.kit.hunts.question import Question

EXERCISE = Question(
    "repair.display_why",
    "A repair · Why it stayed dark",
    "Say what kept the numbers from the display.",
    right="the name of the topic",
    choices=("the message type", "the QoS settings", "the name of the topic", "nothing spun the node"),
).exercise()
